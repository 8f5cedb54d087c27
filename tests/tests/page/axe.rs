//! Can everybody use the page? axe-core, which knows the rules of WCAG, looks at every view of it in Chromium.

use std::path::Path;
use tests::browser::Browser;
use tests::page::Server;
use tests::program::host;

const IDLE: &str = "document.body.dataset.busy === 'false'";

/// What keeps people out, one line a rule with the first places.
const FAULTS: &str = "
    return axe.run(document, { resultTypes: ['violations'] }).then((found) => found.violations
        .filter((one) => ['serious', 'critical'].includes(one.impact))
        .map((one) => `${one.id} (${one.impact}), ${one.help}: ` + one.nodes.slice(0, 5)
            .map((node) => `${node.target.join(' ')}: ${(node.any[0] ?? node.all[0] ?? node.none[0])?.message}`).join('; '))
        .join('\\n'));";

async fn check(browser: &Browser, view: &str, faults: &mut String) {
    for theme in ["light", "dark"] {
        // A dialog keeps its page from being clicked; the theme changes underneath.
        browser.run(&format!("if (document.documentElement.dataset.theme !== '{theme}') theme.click()")).await;
        browser.wait_for(&format!("document.documentElement.dataset.theme === '{theme}'")).await;
        let found = browser.run(FAULTS).await;
        let found = found.as_str().unwrap_or_else(|| panic!("{view}: {found}"));
        if !found.is_empty() {
            *faults += &format!("{view}, {theme}:\n{found}\n");
        }
        browser.keep_picture(&format!("axe-{view}-{theme}")).await;
    }
}

fn prepare(folder: &Path) {
    host(folder, "init --mass 0.1466084 --length 0.1562177 --inertia 0.0027 -o rig.toml").succeeded();
    for (k, angle) in [1.5, -1.2].into_iter().enumerate() {
        let run = format!("simulate mystery-1 --rate 200 --start {angle} --seed {k} -o swing{k}.csv");
        host(folder, &run).succeeded();
    }
    std::fs::write(folder.join("bare.csv"), "a,b\n0,1\n0.1,0.9\n0.2,0.7\n0.3,0.4\n").unwrap();
}

#[test]
#[ignore = "needs axe-core from npm; tests/more axe runs it"]
fn no_view_of_the_page_keeps_anybody_out() {
    let axe = std::fs::read_to_string(std::env::var("AXE").expect("AXE names axe.min.js")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    let server = Server::start(folder.path(), "--rig rig.toml --port sim swing0.csv swing1.csv");
    tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(async {
        let mut faults = String::new();
        for width in [1440, 390] {
            let browser = Browser::open(&server.url, width, 900).await;
            browser.run(&axe).await;
            browser.wait_for("document.body.dataset.ready === 'true'").await;
            browser.wait_for("document.querySelector('#verdict.bad, #verdict.good')").await;
            browser.wait_for(IDLE).await;
            browser.click("#diagnose").await;
            browser.wait_for("document.querySelectorAll('#candidates li').length > 1").await;
            browser.wait_for(IDLE).await;
            browser.click("#candidates li:first-child .name").await;
            browser.run("document.querySelectorAll('details').forEach((one) => { one.open = true; })").await;
            browser.wait_for("document.querySelectorAll('#more-pictures .main-svg').length >= 1").await;
            check(&browser, &format!("model-{width}"), &mut faults).await;

            browser.upload("#upload", &folder.path().join("bare.csv")).await;
            browser.wait_for("document.getElementById('columns-dialog').open").await;
            check(&browser, &format!("columns-{width}"), &mut faults).await;
            browser.click("#columns-no").await;
            browser.click("#push").await;
            browser.wait_for("document.querySelectorAll('#push-table tbody tr').length > 3").await;
            check(&browser, &format!("push-{width}"), &mut faults).await;
            browser.click("#push-no").await;
            browser.run("document.getElementById('formula').value = 'torque = wind'").await;
            browser.click("#formula-add").await;
            browser.wait_for("!document.getElementById('failure').hidden").await;
            check(&browser, &format!("failure-{width}"), &mut faults).await;
            browser.click("#failure-close").await;

            browser.click("#tab-live").await;
            browser.wait_for("Number(document.getElementById('frames').textContent) > 50").await;
            check(&browser, &format!("live-{width}"), &mut faults).await;

            browser.click("#tab-fit").await;
            browser.click("#fit").await;
            browser.wait_for("document.querySelectorAll('#anova tbody tr').length >= 5").await;
            browser.wait_for(IDLE).await;
            check(&browser, &format!("fit-{width}"), &mut faults).await;
            browser.close().await;
        }
        assert!(faults.is_empty(), "{faults}");
    });
}
