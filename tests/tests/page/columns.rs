//! What nobody can know of a file is asked on the page.

use super::{IDLE, alone, block_on};
use std::path::Path;
use tests::browser::Browser;
use tests::hidden::{Gyroscope, Rig};
use tests::page::Server;
use tests::program::host;

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
