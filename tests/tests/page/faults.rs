//! What went wrong is said, and can be put right on the page.

use super::{IDLE, alone, block_on, prepare};
use tests::browser::Browser;
use tests::device::Device;
use tests::page::Server;

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
