//! The page's files, part of the program; and what can be downloaded.

use crate::web;
use std::sync::OnceLock;

/// Name, type and text of every file.
const FILES: [(&str, &str, &str); 16] = [
    ("", HTML, include_str!("page/index.html")),
    ("style.css", CSS, include_str!("page/style.css")),
    ("main.js", JS, include_str!("page/main.js")),
    ("server.js", JS, include_str!("page/server.js")),
    ("numbers.js", JS, include_str!("page/numbers.js")),
    ("words.js", JS, include_str!("page/words.js")),
    ("chart.js", JS, include_str!("page/chart.js")),
    ("plots.js", JS, include_str!("page/plots.js")),
    ("live.js", JS, include_str!("page/live.js")),
    ("compare.js", JS, include_str!("page/compare.js")),
    ("columns.js", JS, include_str!("page/columns.js")),
    ("discover.js", JS, include_str!("page/discover.js")),
    ("evidence.js", JS, include_str!("page/evidence.js")),
    ("findings.js", JS, include_str!("page/findings.js")),
    ("fit.js", JS, include_str!("page/fit.js")),
    ("rig.js", JS, include_str!("page/rig.js")),
];

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const JS: &str = "text/javascript; charset=utf-8";

/// A file by its name: type and text.
pub(super) fn file(name: &str) -> Option<(&'static str, &'static str)> {
    if name == "plotly.js" {
        return Some((JS, plotly()));
    }
    FILES.iter().find(|(known, ..)| *known == name).map(|(_, kind, text)| (*kind, *text))
}

/// The plotting library, as its crate brings it.
fn plotly() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(web::script_text)
}
