//! The page in a real browser: find a hidden effect, add it, push it, watch the rig follow; and what goes wrong.
//! Pictures of every step are kept in `target/page-pictures`.
#![cfg(target_os = "linux")]

// Modules, because what drives the browser takes 20 s to compile for each test program.
#[path = "page/axe.rs"]
mod axe;
#[path = "page/columns.rs"]
mod columns;
#[path = "page/faults.rs"]
mod faults;
#[path = "page/looks.rs"]
mod looks;

use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use tests::browser::Browser;
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
        assert!(words.contains("quadratic-drag: seen "), "{words}");
        assert_eq!(browser.text("#candidates li[data-name=quadratic-drag] .tag").await, "claimed");
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
        assert_eq!(browser.text("#candidates li[data-name=quadratic-drag] .tag").await, "likely");
        let verdict = browser.text("#verdict").await;
        assert!(verdict.contains("thousandths of m·g·l") && !verdict.contains("mN·m"), "{verdict}");
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
