//! The server of the page under attack, and under load: strangers' pages, paths, large and wrong bodies, many at once.
#![cfg(unix)]

use serde_json::{Value, json};
use std::io::{Read, Write};
use std::path::Path;
use std::thread;
use tests::page::{Server, upgrade};
use tests::program::host;

fn server(arguments: &str) -> (tempfile::TempDir, Server) {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start(folder.path(), arguments);
    (folder, server)
}

/// A swing as a file.
fn swing(folder: &Path, options: &str) -> Vec<u8> {
    host(folder, &format!("simulate mystery-1 --rate 200 --seconds 30 {options} -o made.csv --force")).succeeded();
    std::fs::read(folder.join("made.csv")).unwrap()
}

#[test]
fn only_this_servers_own_page_may_ask() {
    let (_folder, server) = server("");
    let own = format!("http://{}", server.address);
    assert_eq!(server.get("/").status, 200);
    assert_eq!(server.ask("GET", "/api/effects", &[("Origin", &own)], &[]).status, 200);
    for host in ["evil.example", &format!("evil.example:{}", server.address.split(':').next_back().unwrap()), ""] {
        server.ask("GET", "/", &[("Host", host)], &[]).refused(421, "not called");
        server.ask("POST", "/api/undo", &[("Host", host)], b"{}").refused(421, "not called");
    }
    for origin in ["http://evil.example", "null", "https://127.0.0.1", "http://127.0.0.1:1"] {
        server.ask("POST", "/api/undo", &[("Origin", origin)], b"{}").refused(403, "another web page");
        server.ask("GET", "/api/effects", &[("Origin", origin)], &[]).refused(403, "another web page");
    }
    server.ask("POST", "/api/fit", &[("Sec-Fetch-Site", "cross-site")], b"{}").refused(403, "another web page");
    server.ask("GET", "/download/rig.toml", &[("Sec-Fetch-Site", "cross-site")], &[]).refused(403, "another web page");
}

#[test]
fn a_strangers_page_gets_no_socket() {
    let (_folder, server) = server("");
    let mut stream = server.connect();
    stream.write_all(upgrade(&server.address, "http://evil.example").as_bytes()).unwrap();
    let mut answer = [0; 12];
    stream.read_exact(&mut answer).unwrap();
    assert_eq!(&answer, b"HTTP/1.1 403");
}

#[test]
fn answers_forbid_frames_foreign_scripts_and_guessed_types() {
    let (_folder, server) = server("");
    for path in ["/", "/main.js", "/plotly.js", "/nothing"] {
        let head = server.get(path).head.to_lowercase();
        assert!(head.contains("content-security-policy: default-src 'none'"), "{path}: {head}");
        assert!(head.contains("frame-ancestors 'none'") && head.contains("nosniff"), "{path}: {head}");
    }
    let page = String::from_utf8(server.get("/").body).unwrap();
    assert!(!page.contains("http://") && !page.contains("https://") && !page.contains("src=\"/"), "an absolute link");
}

#[test]
fn no_path_leads_out_of_the_page() {
    let (folder, server) = server("--port sim");
    std::fs::write(folder.path().join("secret.csv"), "t,theta\n").unwrap();
    for path in [
        "/secret.csv",
        "/../secret.csv",
        "/%2e%2e/secret.csv",
        "/..%2fsecret.csv",
        "/page/index.html",
        "//etc/passwd",
        "/download/../secret.csv",
    ] {
        assert_eq!(server.get(path).status, 404, "{path}");
    }
    for path in ["/download/recording/..%2fsecret.csv", "/api/trace/secret.csv", "/api/trace/-1", "/api/trace/99"] {
        assert!((400..500).contains(&server.get(path).status), "{path}");
    }
    for port in ["/dev/null", "secret.csv", "/etc/passwd", "sim:no-such"] {
        server.post("/api/rig/connect", &format!("{{\"port\":\"{port}\"}}")).refused(422, "not in the list");
    }
    let bytes = swing(folder.path(), "");
    assert_eq!(server.upload("..%2F..%2Fescaped.csv", &bytes).status, 200);
    let state = server.tab().wait_for(|state| state["recordings"].as_array().is_some_and(|all| !all.is_empty()));
    assert_eq!(state["recordings"][0]["name"], "escaped.csv");
    assert!(!folder.path().join("escaped.csv").exists());
}

#[test]
fn wrong_bodies_are_refused_with_a_reason_and_nothing_breaks() {
    let (folder, server) = server("");
    for json in ["", "{", "[]", "{\"add\":5}", "{\"add\":[5]}", "\"\u{0}\"", "{\"values\":1}"] {
        let answer = server.post("/api/change", json);
        assert!((400..500).contains(&answer.status), "{json}: {answer:?}");
        assert!(answer.json()["what"].is_string(), "{json}: {answer:?}");
    }
    server.post("/api/change", "{\"add\":[\"magic\"]}").refused(422, "no effect called magic");
    server.post("/api/formula", "{\"formula\":\"torque = -k*wind; k in 0..1 N·m\"}").refused(422, "wind");
    server.post("/api/formula", &format!("{{\"formula\":\"{}\"}}", "1+".repeat(300))).refused(422, "400");
    server.post("/api/simulate", "{\"recording\":7,\"values\":{}}").refused(422, "no recording 7");
    server.post("/api/pendulum", "{\"mass_kg\":-1,\"length_m\":0.1,\"inertia_kg_m2\":0.1}").refused(422, "mass");
    server.post("/api/pendulum", "{\"mass_kg\":1}").refused(422, "belong together");
    assert!((400..500).contains(&server.post("/api/pendulum", "{\"mass_kg\":1e999}").status));
    server.ask("POST", "/api/change", &[("Content-Type", "text/plain")], b"{}").refused(415, "");
    server.ask("PUT", "/api/change", &[], b"{}").refused(405, "");
    server.post("/api/undo", "{}").refused(422, "no change");
    server.upload("photo.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR").refused(422, "photo.png");
    server.upload("empty.csv", b"").refused(422, "empty.csv");
    server.ask("POST", "/api/model?name=rig.toml", &[], b"this is no model").refused(422, "rig.toml");
    server.ask("POST", "/api/recordings", &[], b"t,theta\n").refused(400, "");

    assert_eq!(
        server.post("/api/pendulum", "{\"mass_kg\":0.147,\"length_m\":0.156,\"inertia_kg_m2\":0.0028}").status,
        204
    );
    let id = server.upload("swing.csv", &swing(folder.path(), "")).json();
    let too_far = format!("{{\"recording\":{id},\"values\":{{\"viscous.Mw\":1e9}}}}");
    server.post("/api/simulate", &too_far).refused(422, "Mw");
    assert_eq!(
        server.post("/api/simulate", &format!("{{\"recording\":{id},\"values\":{{\"viscous.Mw\":1e-3}}}}")).status,
        200
    );
}

#[test]
fn what_is_too_large_is_refused() {
    let (_folder, server) = server("");
    let answer = server.upload("huge.csv", &vec![b'1'; (256 << 20) + 1]);
    assert!(answer.status == 413 || answer.status == 0, "{}", answer.status);
    assert_eq!(server.post("/api/change", &" ".repeat(1 << 17)).status, 413);
    assert_eq!(server.get("/").status, 200);
}

#[test]
fn fifty_requests_at_once_are_all_answered() {
    let (folder, server) = server("");
    let bytes = swing(folder.path(), "");
    server.post("/api/pendulum", "{\"mass_kg\":0.147,\"length_m\":0.156,\"inertia_kg_m2\":0.0028}");
    let id = server.upload("swing.csv", &bytes).json();
    let simulate = format!("{{\"recording\":{id},\"values\":{{\"viscous.Mw\":5e-4}}}}");
    // The same recording would be refused: each is shorter by some rows.
    let rows: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
    let shorter = |n_rows: usize| rows[..rows.len() - n_rows].concat();
    let ask = |k: usize| match k % 5 {
        0 => server.get("/").status,
        1 => server.get(&format!("/api/trace/{id}")).status,
        2 => server.post("/api/simulate", &simulate).status,
        3 => server.upload(&format!("swing-{k}.csv"), &shorter(k)).status,
        _ => server.get("/api/effects").status,
    };
    let statuses: Vec<u16> = thread::scope(|scope| {
        let all: Vec<_> = (0..50).map(|k| scope.spawn(move || ask(k))).collect();
        all.into_iter().map(|one| one.join().unwrap()).collect()
    });
    assert!(statuses.iter().all(|status| *status == 200), "{statuses:?}");
    let state = server.tab().wait_for(|state| state["comparison"].is_object());
    assert_eq!(state["recordings"].as_array().unwrap().len(), 11);
}

#[test]
fn a_file_of_several_runs_comes_in_as_several_recordings() {
    let (folder, server) = server("");
    let made = String::from_utf8(swing(folder.path(), "")).unwrap();
    let rows: String =
        made.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).map(|r| format!("{r}\n")).collect();
    let file = format!("t,theta,other\n{rows}{rows}");
    let id = server.upload("swings.csv", file.as_bytes()).json();
    let state = server.tab().wait_for(|state| state["recordings"].as_array().is_some_and(|all| all.len() == 2));
    let names: Vec<&str> = (0..2).filter_map(|k| state["recordings"][k]["name"].as_str()).collect();
    assert_eq!(names, ["swings.csv, run 1", "swings.csv, run 2"]);
    assert_eq!(state["recordings"][0]["id"], id);
    let kept = server.get(&format!("/download/recording/{id}"));
    assert!(kept.head.contains("swings.csv\""), "{}", kept.head);
    assert_eq!(kept.body, file.as_bytes());
}

#[test]
fn the_same_recording_under_another_name_is_refused_unless_it_takes_the_first_ones_place() {
    let (folder, server) = server("");
    let bytes = swing(folder.path(), "");
    let id = server.upload("swing.csv", &bytes).json();
    let words = "copy.csv holds the same recording as swing.csv, which would count twice";
    server.upload("copy.csv", &bytes).refused(409, words);
    assert_eq!(server.upload(&format!("copy.csv&replaced={id}"), &bytes).status, 200);
    let state = server.tab().wait_for(|state| state["recordings"][0]["name"] == "copy.csv");
    assert_eq!(state["recordings"].as_array().unwrap().len(), 1);
}

#[test]
fn a_modelled_swing_comes_as_a_table_of_what_was_measured_less_what_is_modelled() {
    let (folder, server) = server("");
    server.post("/api/pendulum", "{\"mass_kg\":0.147,\"length_m\":0.156,\"inertia_kg_m2\":0.0028}");
    let id = server.upload("swing.csv", &swing(folder.path(), "")).json();
    server.tab().wait_for(|state| state["comparison"].is_object());
    let table = String::from_utf8(server.get(&format!("/download/modelled/{id}")).body).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("t_s,measured_rad,modelled_rad,residual_rad"));
    let mut largest = 0.0_f64;
    for line in lines {
        let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        assert!((numbers[1] - numbers[2] - numbers[3]).abs() < 2e-7, "{line}");
        largest = largest.max(numbers[3].abs());
    }
    assert!(largest > 1e-4, "{largest}");
}

#[test]
fn ten_tabs_see_one_state() {
    let (folder, server) = server("--port sim:drag --sim-speed 5");
    let id = server.upload("swing.csv", &swing(folder.path(), "")).json();
    let mut tabs: Vec<_> = (0..10).map(|_| server.tab()).collect();
    assert_eq!(server.post(&format!("/api/recordings/{id}/held-out"), "{\"held_out\":true}").status, 204);
    for tab in &mut tabs {
        tab.wait_for(|state| state["recordings"][0]["held_out"] == true);
    }
    let hears_points = |tab: &mut tests::page::Tab| (0..200).any(|_| tab.hear()["type"] == "live");
    assert!(tabs.iter_mut().all(hears_points));
}

#[test]
fn beyond_this_computer_a_token_is_needed() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start_at(folder.path(), "0.0.0.0:0", "");
    let (_, token) = server.url.split_once("?token=").expect("a token");
    assert!(token.len() >= 32);
    server.get("/").refused(401, "token");
    server.get("/?token=0123").refused(401, "token");
    server.get(&format!("/api/effects?token={token}")).refused(401, "token");
    let entered = server.get(&format!("/?token={token}"));
    assert_eq!(entered.status, 303);
    assert!(entered.head.to_lowercase().contains("httponly; samesite=strict"), "{}", entered.head);
    let cookie = format!("rig-token={token}");
    assert_eq!(server.ask("GET", "/", &[("Cookie", &cookie)], &[]).status, 200);
    server.ask("GET", "/", &[("Cookie", &cookie), ("Host", "rig.example")], &[]).refused(421, "not called");
}

#[test]
fn ctrl_c_ends_it_cleanly_while_everything_is_open() {
    let (folder, server) = server("--port sim --sim-speed 5");
    server.upload("swing.csv", &swing(folder.path(), ""));
    let mut tab = server.tab();
    tab.wait_for(|state| state["rig"]["listening"] == true);
    let _idle = server.connect();
    assert_eq!(server.interrupt(), Some(0));
}

#[test]
fn an_address_in_use_is_told() {
    let (folder, server) = server("");
    let run = host(folder.path(), &format!("serve --no-open --listen {}", server.address));
    run.failed(1, &["could not listen", &server.address, "next"]);
}

/// What the page asks before it takes a file in: its columns and rows, and the curve that a choice of them gives.
#[test]
fn a_file_is_shown_before_it_is_taken_in_and_read_as_it_was_wished() {
    let (_folder, server) = server("");
    let angle_deg = |t: f64| 8.0 * (-0.03 * t).exp() * (6.0 * t).cos();
    let rows = (0..600).map(|k| f64::from(k) * 0.02).map(|t| format!("{t:.2};{:.4};1\n", angle_deg(t)));
    let file = format!("when;pot;other\n{}", rows.collect::<String>());
    let ask = |path: &str| server.ask("POST", path, &[], file.as_bytes());
    let blind = ask("/api/preview?name=strange.csv").json();
    assert_eq!(blind["columns"], serde_json::json!(["when", "pot", "other"]));
    assert_eq!((blind["rows"][0][1].as_str(), blind["rows"].as_array().map(Vec::len)), (Some("8.0000"), Some(6)));
    assert!(
        blind["reading"].is_null() && blind["fault"].as_str().is_some_and(|fault| fault.contains("column")),
        "{blind}"
    );
    let told = ask("/api/preview?name=strange.csv&columns=t%3D0,theta%3D1:deg&mirrored=true").json();
    let readings = told["reading"]["readings"].as_array().unwrap();
    assert!((readings[0].as_f64().unwrap() + 8_f64.to_radians()).abs() < 1e-6, "{told}");
    assert_eq!(told["reading"]["unit"], "rad");
    ask("/api/recordings?name=strange.csv").refused(422, "column");
    assert_eq!(ask("/api/recordings?name=strange.csv&columns=t%3D0,theta%3D1:deg").status, 200);
    ask("/api/recordings?name=strange.csv&columns=t%3D0,theta%3D1:furlong").refused(422, "furlong");
}

/// The state once a search has ended.
fn diagnosed(server: &Server) -> Value {
    assert_eq!(server.post("/api/diagnose", "{}").status, 204);
    server.tab().wait_for(|state| state["diagnosis"].is_object())
}

/// In p07 of the examples nothing is hidden but a zero.
#[test]
fn a_zero_that_is_off_is_all_that_is_missing_above_and_below() {
    let (folder, server) = server("");
    host(folder.path(), "init --mass 0.125995 --length 0.149154 --inertia 0.002393").succeeded();
    let model = std::fs::read(folder.path().join("rig.toml")).unwrap();
    assert_eq!(server.ask("POST", "/api/model?name=rig.toml", &[], &model).status, 204);
    let releases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/data/recordings/hidden/p07");
    for k in 1..=3 {
        let name = format!("release_{k}.csv");
        assert_eq!(server.upload(&name, &std::fs::read(releases.join(&name)).unwrap()).status, 200);
    }
    let state = server.tab().wait_for(|state| {
        state["comparison"].is_object() && state["recordings"].as_array().is_some_and(|all| all.len() == 3)
    });
    let above = state["comparison"]["verdict"][1].as_str().unwrap();
    let off = "off by -4.4";
    assert!(above.contains("Nothing is missing at this noise level but the sensor's zero"), "{above}");
    assert!(above.contains(off) && above.contains("host calibrate"), "{above}");
    let state = diagnosed(&server);
    assert_eq!(state["diagnosis"]["verdict"], json!(["angle-offset"]));
    let below = state["zero_words"].as_str().unwrap();
    assert!(below.starts_with("The sensor's zero is") && below.contains(off), "{below}");
}

#[test]
fn a_recording_of_another_pendulum_is_doubted_as_on_the_command_line_and_beside_the_fit() {
    let (folder, server) = server("");
    let swing = |inertia: f64, name: &str, seed: u32| {
        host(folder.path(), &format!("init --mass 0.147 --length 0.156 --inertia {inertia} --force")).succeeded();
        let run = format!("simulate --rig rig.toml --rate 200 --seconds 20 --seed {seed} -o {name}");
        host(folder.path(), &run).succeeded();
        assert_eq!(server.upload(name, &std::fs::read(folder.path().join(name)).unwrap()).status, 200);
    };
    swing(0.0034, "other.csv", 1);
    swing(0.0028, "one.csv", 2);
    swing(0.0028, "two.csv", 3);
    let model = std::fs::read(folder.path().join("rig.toml")).unwrap();
    assert_eq!(server.ask("POST", "/api/model?name=rig.toml", &[], &model).status, 204);
    let state = server.tab().wait_for(|state| state["comparison"].is_object());
    let doubt = state["doubts"][0].as_str().unwrap();
    assert!(doubt.starts_with("doubtful: other.csv: its period of small swings"), "{doubt}");
    let told = host(folder.path(), "fit one.csv two.csv other.csv --rig rig.toml --method least-squares");
    let told = told.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(told.contains(doubt), "{doubt} {told}");

    assert_eq!(server.post("/api/fit", "{}").status, 204);
    let state = server.tab().wait_for(|state| state["fit"].is_object());
    assert_eq!(state["fit"]["warnings"][0], doubt);
    let id = state["recordings"][0]["id"].as_u64().unwrap();
    assert_eq!(server.ask("DELETE", &format!("/api/recordings/{id}"), &[], &[]).status, 204);
    server.tab().wait_for(|state| state["doubts"] == json!([]));
}

/// While the simulated student holds the pendulum up, the observer waits for it to fall. The page is told how fast the
/// measured angle changes, and no velocity where the observer does not follow; of a swing both are told, and agree.
#[test]
fn a_pendulum_that_is_held_has_no_velocity() {
    let (_folder, server) = server("--port sim --sim-speed 10");
    let mut tab = server.tab();
    let (mut n_held, mut n_swinging) = (0, 0);
    let (mut angles, mut most_held, mut most_apart) = (Vec::new(), 0.0_f64, 0.0_f64);
    while n_held < 100 || n_swinging < 1000 {
        let message = tab.hear();
        if message["type"] != "live" {
            continue;
        }
        let numbers = |name: &str| message[name].as_array().unwrap().iter().map(|one| one.as_f64()).collect::<Vec<_>>();
        let (measured, rates, velocities) = (numbers("measured"), numbers("rate"), numbers("velocity"));
        for ((angle, rate), velocity) in measured.into_iter().zip(rates).zip(velocities) {
            angles.push(angle.unwrap());
            let Some(last) = angles.len().checked_sub(N_STILL).map(|from| &angles[from..]) else { continue };
            let (low, high) =
                last.iter().fold((f64::MAX, f64::MIN), |(low, high), one| (low.min(*one), high.max(*one)));
            if high - low < STILL_RAD && low.abs() > UP_RAD {
                assert_eq!(velocity, None, "held at {low} rad");
                n_held += 1;
                most_held = most_held.max(rate.unwrap().abs());
            } else if n_held > 0
                && high - low > UP_RAD
                && let Some(velocity) = velocity
            {
                n_swinging += 1;
                most_apart = most_apart.max((velocity - rate.unwrap()).abs());
            }
        }
    }
    println!("held: up to {most_held} rad/s; swinging: up to {most_apart} rad/s apart");
    // The slope of 20 angles with 1 mrad of noise each; half a span of a fall.
    assert!(most_held < 0.15, "held: {most_held} rad/s");
    assert!(most_apart < 5.0, "swinging: {most_apart} rad/s apart");
}

/// Half a second of points within some noises, far from where it hangs.
const N_STILL: usize = 100;
const STILL_RAD: f64 = 0.02;
const UP_RAD: f64 = 0.3;
