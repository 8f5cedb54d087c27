//! The page in a real browser: find a hidden effect, add it, push it, watch the rig follow; and what goes wrong.
//! Pictures of every step are kept in `target/page-pictures`.
#![cfg(target_os = "linux")]

// A module, because what drives the browser takes 20 s to compile for each test program.
#[path = "page/axe.rs"]
mod axe;

use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use tests::browser::Browser;
use tests::device::Device;
use tests::hidden::{Gyroscope, Rig};
use tests::innovation::after_a_release;
use tests::page::Server;
use tests::program::host;

/// Several browsers at once would only slow each other down.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

fn alone() -> MutexGuard<'static, ()> {
    ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner)
}

fn block_on(test: impl Future<Output = ()>) {
    tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(test);
}

/// The simulated rig runs so many times faster than real time.
const SPEED: f64 = 16.0;

/// A model file and swings of a rig in which something is hidden.
fn prepare(folder: &Path) {
    host(folder, "init --mass 0.1466084 --length 0.1562177 --inertia 0.0027 -o rig.toml").succeeded();
    for (k, angle) in [1.5, -1.2, 0.8].into_iter().enumerate() {
        let seed = k + 1;
        let run = format!("simulate mystery-1 --rate 500 --start {angle} --seed {seed} -o swing{seed}.csv");
        host(folder, &run).succeeded();
    }
}

const IDLE: &str = "document.body.dataset.busy === 'false'";

/// The points that the page draws, and how far they are when this is run, s of the rig's clock.
const TAKE_POINTS: &str =
    "return import('/live.js').then((live) => { window.kept = live.kept; window.asked = kept.t.at(-1) ?? 0; });";

/// The points since then: time, angle and innovation.
const POINTS: &str =
    "return kept.t.map((t, k) => [t, kept.measured[k], kept.innovation[k]]).filter(([t]) => t > asked);";

/// Between two of them, s.
const POINT_S: f64 = 0.005;

/// So many make the swing that is looked at: 10 s.
const N_POINTS: usize = 2000;

/// Longer than the simulated student needs to lift the pendulum and let it go, and that swing, s.
const SWING_S: f64 = 25.0;

/// The innovation in a new swing from 1.5 rad, mrad: of all points that the page draws, by the rig's own clock, so that
/// it does not matter how quickly anybody looks. In between, the simulated student lets go on the other side or from a
/// lesser angle; and to a page that was kept from its work points are missing. Then one of the next swings tells.
async fn innovation_mrad(browser: &Browser) -> f64 {
    loop {
        browser.run(TAKE_POINTS).await;
        browser.click("#again").await;
        browser.wait_for(&format!("kept.t.at(-1) > asked + {SWING_S}")).await;
        let points: Vec<(f64, f32, f32)> = serde_json::from_value(browser.run(POINTS).await).unwrap();
        let gap = points.windows(2).rposition(|pair| pair[1].0 - pair[0].0 > 1.5 * POINT_S);
        let whole: Vec<_> = points[gap.map_or(0, |k| k + 1)..].iter().map(|point| (point.1, point.2)).collect();
        if let Some(rms_rad) = after_a_release(&whole, N_POINTS) {
            return 1e3 * rms_rad;
        }
    }
}

#[test]
fn a_hidden_effect_is_found_added_and_pushed_and_the_rig_follows_its_pendulum() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    let server = Server::start(folder.path(), &format!("--port sim:mystery-1 --sim-speed {SPEED}"));
    block_on(async {
        let browser = Browser::open(&server.url, 1440, 900).await;
        browser.wait_for("document.body.dataset.ready === 'true'").await;
        assert_eq!(browser.run("return document.getElementById('view-live').hidden").await, false);
        browser.click("#tab-model").await;
        for k in 1..=3 {
            browser.upload("#upload", &folder.path().join(format!("swing{k}.csv"))).await;
            browser.wait_for(&format!("document.querySelectorAll('#recordings li').length === {k}")).await;
        }
        browser.wait_for("document.querySelector('#verdict.bad')").await;
        browser.wait_for(IDLE).await;
        let verdict = browser.text("#verdict").await;
        assert!(verdict.contains("physics is missing"), "{verdict}");
        let before = browser.number("#ratio").await.unwrap();
        assert!(before > 5.0, "{before}");
        browser.wait_for("document.querySelectorAll('#pictures .main-svg').length >= 3").await;
        browser.keep_picture("1-physics-is-missing").await;

        browser.click("#diagnose").await;
        browser.wait_for("document.querySelectorAll('#candidates li').length > 1").await;
        browser.wait_for(IDLE).await;
        let words = browser.text("#diagnosis-words").await;
        assert!(words.contains(" quadratic-drag: seen "), "{words}");
        browser.click("#candidates li:first-child .name").await;
        let explanation = browser.text("#explanation").await;
        assert!(explanation.contains("quadratic-drag") && explanation.contains("torque ="), "{explanation}");
        browser.wait_for(NONE_IS_WORSE_THAN_THE_BASE_MODEL).await;
        browser.keep_picture("2-candidates").await;

        browser.click("#candidates li:first-child .add").await;
        browser.wait_for("document.querySelectorAll('#staircase .step').length === 3").await;
        browser.wait_for("document.querySelector('#verdict.good')").await;
        browser.wait_for(IDLE).await;
        let after = browser.number("#ratio").await.unwrap();
        assert!((0.95..1.05).contains(&after), "the error fell from {before} to {after} noises");
        let found = browser.text("#discover").await;
        assert!(found.contains("Outdated") && found.contains("Already in the model: quadratic-drag"), "{found}");
        browser.keep_picture("3-only-noise-is-left").await;

        browser.click("#tab-live").await;
        let old_mrad = innovation_mrad(&browser).await;
        browser.keep_picture("4-live-before").await;
        browser.click("#tab-model").await;
        browser.click("#push").await;
        browser.wait_for("document.getElementById('push-dialog').open").await;
        let table = browser.text("#push-table").await;
        assert!(table.contains("absent") && table.contains("Cq"), "{table}");
        browser.keep_picture("5-push").await;
        browser.click("#push-yes").await;
        browser.wait_for("document.getElementById('live-note').textContent.includes('read back the same')").await;
        browser.click("#tab-live").await;
        let new_mrad = innovation_mrad(&browser).await;
        browser.keep_picture("6-live-after").await;
        assert!(new_mrad < 0.6 * old_mrad, "innovation before {old_mrad} mrad, after {new_mrad} mrad");

        browser.click("#tab-model").await;
        browser.click("#undo").await;
        browser.wait_for("document.querySelector('#verdict.bad')").await;
        assert!(browser.number("#ratio").await.unwrap() > 5.0);
        browser.close().await;
    });
}

/// The list ends with the base model, which has a name that says so.
const NONE_IS_WORSE_THAN_THE_BASE_MODEL: &str = "(() => {
  const all = [...document.querySelectorAll('#candidates li')];
  const left = (li) => parseFloat(li.querySelector('.left').textContent);
  const base = all.find((li) => li.dataset.name === 'none');
  return base && base.querySelector('.name').textContent === 'base model' && all.every((li) => left(li) <= left(base));
})()";

#[test]
fn a_slider_shows_what_a_number_does_and_the_fit_tells_its_story() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    let server = Server::start(folder.path(), "--rig rig.toml swing1.csv");
    block_on(async {
        let browser = Browser::open(&server.url, 1280, 720).await;
        browser.wait_for("document.querySelector('#verdict.bad')").await;
        browser.wait_for(IDLE).await;
        let before = browser.number("#ratio").await.unwrap();
        browser
            .run(
                "const slider = document.querySelector('#sliders input[data-name=\"coulomb.Mc\"]');
                 slider.value = slider.max; slider.dispatchEvent(new Event('input'));",
            )
            .await;
        browser.wait_for("document.querySelector('#ratio')?.innerText.includes('what if')").await;
        assert!(browser.number("#ratio").await.unwrap() > 2.0 * before);
        browser.keep_picture("7-what-if").await;
        browser.click("#reset-values").await;

        browser.click("#tab-fit").await;
        browser.click("#fit").await;
        browser.wait_for("document.querySelectorAll('#identified tbody tr').length >= 5").await;
        browser
            .wait_for("document.querySelector('#contour .main-svg') && document.querySelector('#path .main-svg')")
            .await;
        browser.wait_for("document.querySelectorAll('#anova tbody tr').length >= 5").await;
        browser.wait_for(IDLE).await;
        browser.keep_picture("8-fit").await;
        browser.run("document.getElementById('contour').scrollIntoView()").await;
        browser.wait_for("document.getElementById('contour').getBoundingClientRect().top < innerHeight").await;
        browser.keep_picture("9-surface").await;

        browser.click("#theme").await;
        browser.click("#tab-model").await;
        browser.keep_picture("10-dark").await;
        browser.close().await;
    });
}

/// A rod in air from a large angle: one release of it proves no law.
#[test]
fn what_no_law_explains_is_drawn_as_a_friction_curve_that_can_be_added_and_taken_out_again() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let swing = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/data/recordings/real/more/pendulepi_release_a.csv");
    host(folder.path(), "init --unknown-geometry").succeeded();
    let server = Server::start(folder.path(), &format!("--rig rig.toml {}", swing.display()));
    block_on(async {
        let browser = Browser::open(&server.url, 1280, 720).await;
        browser.wait_for("document.querySelector('#verdict.bad')").await;
        browser.wait_for(IDLE).await;
        let before = browser.number("#ratio").await.unwrap();
        browser.click("#diagnose").await;
        browser.wait_for("document.querySelector('#friction-curve .main-svg')").await;
        browser.wait_for(IDLE).await;
        let words = browser.text("#diagnosis-words").await;
        assert!(words.contains("Likely, but not proven: quadratic-drag"), "{words}");
        let words = browser.text("#curve-words").await;
        assert!(words.contains("a free friction curve") && words.contains("It resembles power-law-drag"), "{words}");
        browser.run("document.getElementById('friction-curve').scrollIntoView()").await;
        browser.keep_picture("20-friction-curve").await;

        browser.click("#curve-add").await;
        browser.wait_for("document.querySelector('#curve-add').innerText === 'Remove it'").await;
        browser.wait_for(IDLE).await;
        let after = browser.number("#ratio").await.unwrap();
        assert!(after < 0.1 * before, "{after} of {before}");
        browser.keep_picture("21-friction-curve-added").await;
        browser.click("#curve-add").await;
        browser.wait_for("document.querySelector('#curve-add').innerText === 'Add it'").await;
        browser.close().await;
    });
}

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

#[test]
fn a_wrong_file_is_named_and_the_page_goes_on() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    std::fs::write(folder.path().join("holiday.csv"), b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR and so on").unwrap();
    let server = Server::start(folder.path(), "--rig rig.toml");
    block_on(async {
        let browser = Browser::open(&server.url, 1280, 720).await;
        browser.wait_for("document.body.dataset.ready === 'true'").await;
        browser.upload("#upload", &folder.path().join("holiday.csv")).await;
        browser.wait_for("!document.getElementById('failure').hidden").await;
        let words = browser.text("#failure").await;
        assert!(words.contains("holiday.csv") && words.contains("Next:"), "{words}");
        browser.keep_picture("11-wrong-file").await;
        browser.click("#failure-close").await;
        browser.upload("#upload", &folder.path().join("swing3.csv")).await;
        browser.wait_for("document.querySelectorAll('#recordings li').length === 1").await;
        browser.wait_for(IDLE).await;
        std::fs::copy(folder.path().join("swing3.csv"), folder.path().join("again.csv")).unwrap();
        browser.upload("#upload", &folder.path().join("again.csv")).await;
        browser.wait_for("!document.getElementById('failure').hidden").await;
        let words = browser.text("#failure").await;
        assert!(words.contains("again.csv holds the same recording as swing3.csv, which would count twice"), "{words}");
        browser.close().await;
    });
}

/// What a person does who types these into the form.
fn geometry(mass_kg: &str, length_m: &str, inertia_kg_m2: &str) -> String {
    let values = format!("{{ mass_kg: '{mass_kg}', length_m: '{length_m}', inertia_kg_m2: '{inertia_kg_m2}' }}");
    format!(
        "const form = document.getElementById('geometry-form');
         for (const [name, value] of Object.entries({values})) form.elements[name].value = value;"
    )
}

const VERDICT: &str = "document.getElementById('verdict').innerText";

#[test]
fn why_nothing_is_compared_is_said_and_can_be_put_right_on_the_page() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    // Otherwise the page begins with its model.
    std::fs::remove_file(folder.path().join("rig.toml")).unwrap();
    let server = Server::start(folder.path(), "swing1.csv");
    block_on(async {
        let browser = Browser::open(&server.url, 1280, 720).await;
        browser.wait_for("document.querySelectorAll('#recordings li').length === 1").await;
        browser.run(&geometry("14.7", "15.6", "28")).await;
        browser.click("#geometry-form [type=submit]").await;
        browser.wait_for(&format!("{VERDICT}.includes('Nothing is compared: swing1.csv')")).await;
        browser.click("#failure-close").await;
        browser.client.refresh().await.unwrap();
        browser.wait_for(&format!("{VERDICT}.includes('Nothing is compared: swing1.csv')")).await;
        browser.keep_picture("23-nothing-is-compared").await;
        browser.run(&geometry("0.1466084", "0.1562177", "0.0027")).await;
        browser.click("#geometry-form [type=submit]").await;
        browser.wait_for("document.querySelector('#verdict.bad')").await;
        browser.wait_for("!document.getElementById('geometry').open").await;
        browser.click("#recordings input").await;
        browser.wait_for(&format!("{VERDICT}.includes('All recordings are held out')")).await;
        browser.click("#recordings input").await;
        browser.wait_for("document.querySelector('#verdict.bad')").await;
        browser.click("#geometry-title").await;
        browser.run(&geometry("0.2", "0.1562177", "0.0027")).await;
        browser.click("#geometry-form [type=submit]").await;
        browser.wait_for(IDLE).await;
        browser.wait_for("document.querySelector('#verdict.bad')").await;
        let mass = browser.run("return document.getElementById('geometry-form').elements.mass_kg.value").await;
        assert_eq!(mass, "0.2");
        browser.close().await;
    });
}

/// The message is within the window, below the header.
const IN_SIGHT: &str = "(() => {
  const box = document.getElementById('failure').getBoundingClientRect();
  const header = document.querySelector('header').getBoundingClientRect();
  return box.height > 0 && box.top >= Math.max(header.bottom - 1, 0) && box.bottom <= innerHeight;
})()";

#[test]
fn what_went_wrong_is_in_sight_far_down_on_a_phone_with_a_mark_where_it_is_wrong() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    let server = Server::start(folder.path(), "--rig rig.toml swing1.csv");
    block_on(async {
        let browser = Browser::open(&server.url, 390, 844).await;
        browser.wait_for("document.querySelector('#verdict.bad')").await;
        browser.wait_for(IDLE).await;
        let below_verdict = "document.getElementById('discover').getBoundingClientRect().top - document.getElementById('verdict').getBoundingClientRect().bottom < 30";
        browser.wait_for(below_verdict).await;
        browser.run("document.getElementById('formula').value = 'torque = -k*foo; k in 0..1'").await;
        browser.click("#formula-add").await;
        browser.run("scrollTo(0, document.body.scrollHeight)").await;
        browser.wait_for(IN_SIGHT).await;
        assert_eq!(
            browser.run("return document.getElementById('failure-place').textContent").await,
            "  torque = -k*foo; k in 0..1\n              ^^^"
        );
        let next = browser.text("#failure-next").await;
        assert!(next.starts_with("Next: write it like"), "{next}");
        browser.keep_picture("24-in-sight").await;
        let long = format!(
            "document.getElementById('formula').value = 'torque = -k*(omega{}); k in 0..1'",
            "+omega".repeat(40)
        );
        browser.run(&long).await;
        browser.click("#formula-add").await;
        browser.wait_for("document.getElementById('failure-what').textContent.includes('room for 120')").await;
        let next = browser.text("#failure-next").await;
        assert!(!next.contains("write it like"), "{next}");
        browser.close().await;
    });
}

#[test]
fn an_unplugged_rig_is_told_and_what_to_do_about_it() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let device = Device::rig("plain");
    let server = Server::start(folder.path(), &format!("--port {}", device.port));
    block_on(async {
        let browser = Browser::open(&format!("{}#live", server.url), 1280, 720).await;
        browser.wait_for("document.getElementById('rig-state').textContent.includes('live')").await;
        browser.wait_for("Number(document.getElementById('frames').textContent) > 50").await;
        device.unplug();
        browser.wait_for("document.getElementById('rig-state').textContent.includes('lost')").await;
        let words = browser.text("#live-note").await;
        assert!(words.contains("broke") && words.contains("cable"), "{words}");
        browser.keep_picture("12-unplugged").await;
        browser.close().await;
    });
}

#[test]
fn a_swing_is_recorded_on_the_page_and_appears_in_the_list() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start(folder.path(), "--port sim:drag --sim-speed 60");
    block_on(async {
        let browser = Browser::open(&format!("{}#live", server.url), 1280, 720).await;
        browser.click("#record").await;
        browser.wait_for("document.getElementById('live-note').textContent.includes('released')").await;
        browser.keep_picture("13-recording").await;
        browser.wait_for("document.querySelectorAll('#recordings li').length === 1").await;
        browser.click("#tab-model").await;
        browser.wait_for("document.querySelector('#verdict.bad, #verdict.good, #verdict.unsure')").await;
        browser.close().await;
    });
    let csv =
        |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().path().extension().is_some_and(|end| end == "csv");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().filter_map(|entry| csv(entry).then_some(())).count(), 1);
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

/// What a person does who chooses or types this in the dialog.
fn choose(id: &str, value: &str) -> String {
    format!(
        "const chosen = document.getElementById('{id}'); chosen.value = '{value}'; chosen.dispatchEvent(new Event('change', {{ bubbles: true }}));"
    )
}

/// The page, on which the dialog asks for the columns of this file.
async fn asked_for_columns(server: &Server, file: &Path) -> Browser {
    let browser = Browser::open(&server.url, 1280, 900).await;
    browser.wait_for("document.body.dataset.ready === 'true'").await;
    browser.upload("#upload", file).await;
    browser.wait_for("document.getElementById('columns-dialog').open").await;
    browser.wait_for("document.querySelectorAll('#columns-rows tbody tr').length >= 5").await;
    browser
}

/// A potentiometer's counts, which have no unit of their own.
#[test]
fn counts_are_read_once_it_is_said_how_many_a_turn_has() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "init --unknown-geometry").succeeded();
    let row = |k: u32| {
        let t = f64::from(k) * 0.01;
        let angle_rad = 1.1 * (-0.03 * t).exp() * (6.0 * t).cos();
        format!("{t:.2},{:.0}\n", 2048.0 + 4096.0 * angle_rad / std::f64::consts::TAU)
    };
    let rows: String = (0..1500).map(row).collect();
    std::fs::write(folder.path().join("counts.csv"), format!("time,pot\n{rows}")).unwrap();
    let server = Server::start(folder.path(), "--rig rig.toml");
    block_on(async {
        let browser = asked_for_columns(&server, &folder.path().join("counts.csv")).await;
        let fault = browser.text("#columns-fault").await;
        assert!(fault.contains("what one is worth. Say in the fields below") && !fault.contains("--"), "{fault}");
        browser.run(&choose("columns-reading", "1")).await;
        browser.run(&choose("columns-zero", "2048")).await;
        browser.run(&choose("columns-unit", "counts, of which a turn has")).await;
        browser.wait_for("!document.getElementById('columns-worth').hidden").await;
        browser.run(&choose("columns-worth", "4096")).await;
        browser.wait_for("document.body.dataset.columns === 'angle'").await;
        browser.keep_picture("16-counts").await;
        browser.click("#columns-yes").await;
        browser.wait_for("document.querySelectorAll('#recordings li').length === 1").await;
        browser.close().await;
    });
}

/// A gyroscope's file whose columns nobody can guess, read from the page alone.
#[test]
fn columns_units_and_sign_are_asked_with_the_curve_and_rates_are_fitted() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let rig = Rig { releases_rad: vec![1.2], ..Rig::random(5) };
    let phone = Gyroscope { scale: 1.02, bias_rad_s: 0.013, noise_rad_s: 4e-3, rate_hz: 200.0 };
    let rows = phone.file(&rig, 0, "rad/s", 1.0);
    let bare: String = rows.lines().skip(1).map(|row| row.to_owned() + "\n").collect();
    std::fs::write(folder.path().join("phone.csv"), format!("a,b,c,d,e\n{bare}")).unwrap();
    let Rig { mass_kg, length_m, drawn_inertia_kg_m2, .. } = &rig;
    host(folder.path(), &format!("init --mass {mass_kg} --length {length_m} --inertia {drawn_inertia_kg_m2}"))
        .succeeded();
    let server = Server::start(folder.path(), "--rig rig.toml");
    block_on(async {
        let browser = asked_for_columns(&server, &folder.path().join("phone.csv")).await;
        browser.run(&choose("columns-time", "0")).await;
        browser.run(&choose("columns-reading", "3")).await;
        browser.run(&choose("columns-unit", "rate, rad/s")).await;
        browser.wait_for("document.body.dataset.columns === 'rate'").await;
        browser.keep_picture("14-columns").await;
        browser.click("#columns-yes").await;
        browser.wait_for("document.querySelectorAll('#recordings li').length === 1").await;
        browser.wait_for("document.querySelector('#verdict.good')").await;
        browser.wait_for(IDLE).await;
        let verdict = browser.text("#verdict").await;
        assert!(verdict.contains("mrad/s") && verdict.contains("Nothing is missing"), "{verdict}");
        browser.keep_picture("15-rates").await;
        browser.close().await;
    });
}
