//! Does it fit every screen, and can everything on it be read?

use super::{IDLE, alone, block_on, prepare};
use tests::browser::Browser;
use tests::page::Server;

/// Labels of plots that lie on each other or reach beyond their plot.
const MISPLACED: &str = "
    const lie = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
    return [...document.querySelectorAll('.plot')].flatMap((plot) => {
        const edge = plot.getBoundingClientRect();
        const texts = plot.querySelectorAll('[class$=tick] text, text[class$=xtitle], text[class$=ytitle], .legendtext');
        const boxes = [...texts].filter((text) => text.textContent.trim())
            .map((text) => [text.textContent, text.getBoundingClientRect()]);
        const reaches = (box) => box.left < edge.left - 1 || box.right > edge.right + 1 || box.top < edge.top - 1;
        const reach = boxes.filter(([, box]) => reaches(box)).map(([name]) => `${name} beyond`);
        const under = (box, k) => boxes.slice(k + 1).filter(([, other]) => lie(box, other)).map(([name]) => name);
        const pairs = boxes.flatMap(([name, box], k) => under(box, k).map((other) => `${name} on ${other}`));
        return [...reach, ...pairs];
    });";

/// Every plot is drawn and has its labels.
const ALL_LABELLED: &str =
    "[...document.querySelectorAll('.plot')].filter((plot) => plot.clientWidth).every((plot) => plot.dataset.labelled)";

/// Labels move until the last plot has its size, which no event tells.
async fn wait_until_placed(browser: &Browser) {
    browser.wait_for(&format!("(() => {{ {MISPLACED} }})().length === 0")).await;
}

const LEGENDS: &str = "return [...document.querySelectorAll('#pictures .legendtext')].map((text) => text.textContent);";

/// Names whose ends can't be read in the list.
const HIDDEN_ENDS: &str = "
    return [...document.querySelectorAll('#recordings .name')].filter((name) => {
        const end = name.lastElementChild?.getBoundingClientRect();
        return !end || end.right > name.getBoundingClientRect().right + 1;
    }).length;";

#[test]
fn on_a_phone_no_label_lies_on_another_and_long_names_are_told_apart() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    let long = |k: usize| {
        format!("recorded-on-monday-morning-with-the-new-bearing-and-the-old-bob-of-brass-as-release-{k}.csv")
    };
    for k in 1..=3 {
        std::fs::rename(folder.path().join(format!("swing{k}.csv")), folder.path().join(long(k))).unwrap();
    }
    let server = Server::start(
        folder.path(),
        &format!("--rig rig.toml {} {} {} --port sim --sim-speed 0.1", long(1), long(2), long(3)),
    );
    block_on(async {
        let browser = Browser::open(&format!("{}#live", server.url), 390, 844).await;
        // A pendulum that still hangs has the smallest numbers beside its charts, and so the longest.
        browser.wait_for("document.getElementById('live-angle').dataset.besideUnit !== undefined").await;
        for chart in ["angle", "velocity", "innovation", "friction"] {
            let room = browser
                .run(&format!("return Number(document.getElementById('live-{chart}').dataset.besideUnit)"))
                .await;
            assert!(room.as_f64() > Some(2.0), "{chart}: {room}");
        }
        browser.click("#tab-model").await;
        browser.wait_for("document.querySelector('#verdict.bad')").await;
        browser.wait_for(IDLE).await;
        browser.run("document.getElementById('more').open = true").await;
        browser.wait_for("document.querySelectorAll('#more-pictures .plot').length > 8").await;
        browser.wait_for(ALL_LABELLED).await;
        let legends = browser.run(LEGENDS).await;
        assert!(
            legends.as_array().is_some_and(|all| all.contains(&"recorded-on-mon…ss-as-release-3".into())),
            "{legends}"
        );
        wait_until_placed(&browser).await;
        assert_eq!(browser.run(HIDDEN_ENDS).await, 0);
        browser.keep_picture("22-phone").await;

        browser.click("#tab-fit").await;
        browser.click("#fit").await;
        browser
            .wait_for("document.querySelector('#path .main-svg') && document.querySelector('#optimizer .main-svg')")
            .await;
        browser.wait_for(IDLE).await;
        browser.wait_for(ALL_LABELLED).await;
        wait_until_placed(&browser).await;
        browser.close().await;
    });
}

/// Is each picture below the verdict as wide as its place?
const FILL_THEIR_PLACE: &str = "[...document.querySelectorAll('#pictures .plot')].every((plot) =>
    plot.clientWidth > 0 && plot.querySelector('.main-svg').clientWidth === plot.clientWidth)";

#[test]
fn pictures_that_were_drawn_in_a_tab_out_of_sight_fill_their_place() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    let server = Server::start(folder.path(), "--rig rig.toml swing1.csv swing2.csv --port sim --sim-speed 0.1");
    block_on(async {
        let browser = Browser::open(&format!("{}#live", server.url), 1440, 900).await;
        let drawn = "document.querySelectorAll('#pictures .plot[data-labelled]').length > 1";
        browser.wait_for(drawn).await;
        browser.click("#tab-model").await;
        browser.wait_for(FILL_THEIR_PLACE).await;
        browser.close().await;
    });
}

/// Phone, tablet, laptop, large screen.
const WIDTHS: [u32; 4] = [390, 768, 1440, 1920];

/// Nothing is wider than the window, and every element with text of its own ends within it.
const FITS: &str = "
    const wide = document.documentElement.scrollWidth;
    const out = [...document.querySelectorAll('main *, header *')].filter((one) => {
        const box = one.getBoundingClientRect();
        return box.width > 0 && (box.right > innerWidth + 1 || box.left < -1) && !one.closest('.scroll, .plot, svg, .skip');
    });
    return wide <= innerWidth ? out.map((one) => one.id || one.className || one.tagName).join() : `page ${wide} wide`;";

/// What the eye sees: the background of page and plots and what is painted on the canvases are all light, or all dark.
const LOOKS: &str = "(() => {
    const brightness = (rgb) => rgb.slice(0, 3).reduce((sum, part) => sum + Number(part), 0) / 3;
    const named = (text) => brightness(text.match(/[0-9.]+/g));
    const shown = (one) => one.checkVisibility() && one.clientWidth > 0;
    const paper = [getComputedStyle(document.body).backgroundColor,
        ...[...document.querySelectorAll('.main-svg .bg, .main-svg .gtitle')].map((one) => getComputedStyle(one).fill),
        ...[...document.querySelectorAll('.js-plotly-plot .main-svg:first-of-type')].map((one) => one.style.background)];
    const ink = [...document.querySelectorAll('.xtick text, .ytick text')].map((one) => getComputedStyle(one).fill);
    const labels = [...document.querySelectorAll('canvas')].filter((one) => shown(one) && one.dataset.labelsUp).map((canvas) => {
        const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
        const quiet = getComputedStyle(document.documentElement).getPropertyValue('--quiet').trim();
        const wanted = [1, 3, 5].map((at) => parseInt(quiet.slice(at, at + 2), 16));
        for (let at = 0; at < pixels.length; at += 4)
            if (wanted.every((part, k) => Math.abs(pixels[at + k] - part) < 12) && pixels[at + 3] > 200) return true;
        return false;
    });
    const all = (dark) => paper.filter((one) => /[0-9]/.test(one) && !/, 0[)]/.test(one)).every((one) => (named(one) < 100) === dark)
        && ink.every((one) => (named(one) > 150) === dark) && labels.every((one) => one);
    return all(true) ? 'dark' : all(false) ? 'light' : 'mixed';
})()";

/// Axes that are shown with fewer than three labels.
const FEW_LABELS: &str = "(() => {
    const few = [];
    const shown = (one) => one.checkVisibility() && one.clientWidth > 0;
    for (const canvas of [...document.querySelectorAll('canvas')].filter((one) => shown(one) && one.dataset.labelsUp)) {
        const { labelsUp, labelsAcross } = canvas.dataset;
        if (Math.min(labelsUp, labelsAcross) < 3) few.push(`${canvas.id}: ${labelsUp} up, ${labelsAcross} across`);
    }
    for (const plot of [...document.querySelectorAll('.js-plotly-plot')].filter(shown)) {
        for (const axis of Object.keys(plot._fullLayout).filter((name) => /^[xy]axis/.test(name))) {
            const letter = axis[0] + axis.slice(5);
            const labels = [...plot.querySelectorAll(`.${letter}tick text`)].filter((one) => one.textContent.trim() !== '');
            const { type, visible, showticklabels } = plot._fullLayout[axis];
            if (visible && showticklabels && type !== 'category' && labels.length < 3) {
                few.push(`${plot.id || plot.closest('.card')?.querySelector('h2, h3')?.textContent} ${letter}: ${labels.map((one) => one.textContent).join(' ')}`);
            }
        }
    }
    return few.join('; ');
})()";

#[test]
fn the_page_fits_phones_and_large_screens_in_light_and_dark() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    let server = Server::start(folder.path(), "--rig rig.toml --port sim swing1.csv swing2.csv");
    block_on(async {
        for width in WIDTHS {
            let browser = Browser::open(&server.url, width, 900).await;
            browser.wait_for("document.querySelector('#verdict.bad')").await;
            browser.wait_for(IDLE).await;
            browser.wait_for("document.querySelectorAll('#pictures .main-svg').length >= 2").await;
            browser.click("#tab-fit").await;
            if width == WIDTHS[0] {
                browser.click("#fit").await;
            }
            browser.wait_for("document.querySelectorAll('#fit-story .main-svg').length >= 4").await;
            browser.wait_for(IDLE).await;
            browser.click("#tab-live").await;
            browser.wait_for("document.getElementById('live-velocity').dataset.labelsUp").await;
            let inside = browser.run("return innerWidth").await.as_u64().unwrap();
            assert!(inside.abs_diff(u64::from(width)) <= 20, "{inside} pixels for {width}");
            for theme in ["light", "dark"] {
                if browser.run("return document.documentElement.dataset.theme").await != theme {
                    browser.click("#theme").await;
                }
                browser.wait_for(&format!("document.documentElement.dataset.theme === '{theme}'")).await;
                for tab in ["model", "live", "fit"] {
                    browser.click(&format!("#tab-{tab}")).await;
                    assert_eq!(browser.run(FITS).await, "", "{tab} at {width} pixels, {theme}");
                    browser.wait_for(&format!("({LOOKS}) === '{theme}'")).await;
                    browser.wait_for(&format!("({FEW_LABELS}) === ''")).await;
                    browser.keep_picture(&format!("width-{width}-{tab}-{theme}")).await;
                }
            }
            browser.close().await;
        }
    });
}
