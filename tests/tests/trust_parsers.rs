//! Whatever bytes or text come in, parsers answer: no panic, no hang, no memory kept. Inputs are the files of
//! `tests/corpus`, edited at random. `BOLERO_RANDOM_ITERATIONS` makes it more; a failure prints the seed that brings it
//! back.

use axum::Router;
use axum::body::{Body, to_bytes};
use axum::http::Request;
use bolero::check;
use host::formula;
use host::recording::{ReadOptions, read_bytes};
use host::rigfile::RigFile;
use host::serve::{Settings, unplugged};
use shared::parameters::Parameters;
use shared::rig::{MAX_STORED, Outcome, Rig, Stored};
use shared::units::{Code, Radian};
use shared::wire::{self, Command, Deframer, Frame, Hello, MAX_FRAME, StoreState, Stream};
use std::panic::AssertUnwindSafe;
use std::time::{Duration, Instant};
use tests::HANG;
use tests::edits::Seeds;
use tests::memory;
use tower::ServiceExt;

/// Memory may grow by this much, and no more however long it goes on: buffers, and the formulas that are kept.
const MOST_GROWTH: u64 = 128 << 20;

/// Counts inputs, and looks at what each takes.
struct Watch {
    began: Instant,
    before: u64,
    n_inputs: u64,
    n_good: u64,
    longest: Duration,
}

impl Watch {
    fn look(&mut self, parse: impl FnOnce() -> bool) {
        let began = Instant::now();
        self.n_good += u64::from(parse());
        self.longest = self.longest.max(began.elapsed());
        self.n_inputs += 1;
    }

    fn end(&self, name: &str) {
        let Self { began, before, n_inputs, n_good, longest } = self;
        let growth = memory::resident().saturating_sub(*before);
        println!(
            "{name}: {n_inputs} inputs, {n_good} good, in {:.0} s, the longest took {longest:?}; memory grew by {} KB, \
             to {} MB at most",
            began.elapsed().as_secs_f64(),
            growth >> 10,
            memory::peak() >> 20
        );
        assert!(*longest < HANG, "{longest:?}");
        assert!(growth < MOST_GROWTH, "memory grew by {growth} bytes");
        // Inputs that are all refused at once would prove little.
        assert!(*n_inputs > 100 && *n_good > n_inputs / 100, "{n_good} of {n_inputs} inputs were good");
    }
}

/// Edited seeds into a parser, which says whether the input was good.
fn attack(name: &str, seeds: &Seeds, mut parse: impl FnMut(&[u8]) -> bool) {
    let (began, before) = (Instant::now(), memory::resident());
    let mut watch = Watch { began, before, n_inputs: 0, n_good: 0, longest: Duration::ZERO };
    let mut look = AssertUnwindSafe(|orders: &[u8]| watch.look(|| parse(&seeds.edited(orders))));
    check!().for_each(move |orders: &[u8]| {
        // Named whole, because only the whole is marked as safe to unwind.
        let look = &mut look;
        (look.0)(orders);
    });
    watch.end(name);
}

/// Messages of many kinds.
fn messages() -> Vec<Frame> {
    let parameters = Parameters::paper().map(|value| value as f32);
    vec![
        Frame::Hello(Hello::new("fuzz")),
        Frame::Command(1, Command::SetParameters((&parameters).into())),
        Frame::Command(2, Command::SetSettings(settings_of_a_rig())),
        Frame::Command(3, Command::Start(Stream { raw: true, live_every: 10 })),
        Frame::Command(4, Command::CalibrateGain(Radian(1.0))),
        Frame::Command(5, Command::Statistics),
        Frame::CustomFormula([1, 2, 3, 4, 5, 6, 7, 8].into_iter().collect()),
        Frame::FrictionCurve([[0.0, 1e-3], [1.0, 2e-3], [4.0, 3e-3]].into_iter().collect()),
    ]
}

fn settings_of_a_rig() -> wire::Settings {
    *Rig::new("fuzz", 4095, Err(StoreState::Empty)).settings()
}

#[test]
fn frames() {
    let encoded = |frame: &Frame| wire::encode(frame, &mut [0; MAX_FRAME]).unwrap().to_vec();
    let seeds = Seeds::new(messages().iter().map(encoded).collect());
    let hello = encoded(&messages()[0]);
    attack("frames", &seeds, |bytes| {
        let (mut at_pc, mut at_rig) = (Deframer::new(), Deframer::new());
        let mut n_good = 0;
        for byte in bytes {
            n_good += u32::from(matches!(at_pc.push(*byte), Some(Ok(_))));
            let _ = at_rig.push_at_rig(*byte);
        }
        // Whatever came before, the next whole frame is understood.
        let mut last = at_pc.push(0);
        hello.iter().for_each(|byte| last = at_pc.push(*byte));
        assert!(matches!(last, Some(Ok(Frame::Hello(_)))));
        n_good > 0
    });
}

/// A check sum stops nearly every edit; a stranger who knows it gets this far.
#[test]
fn messages_with_a_right_check_sum() {
    let encoded = |frame: &Frame| postcard::to_slice(frame, &mut [0; MAX_FRAME]).unwrap().to_vec();
    let seeds = Seeds::new(messages().iter().map(encoded).collect());
    let mut rig = Rig::new("fuzz", 4095, Err(StoreState::Empty));
    let fits = |frame: Frame| assert!(wire::encode(&frame, &mut [0; MAX_FRAME]).is_ok(), "{frame:?}");
    attack("messages", &seeds, |bytes| {
        let Ok(frame) = postcard::from_bytes::<Frame>(bytes) else { return false };
        if let Outcome::Send(frame) = rig.on_frame(frame) {
            fits(frame);
        }
        rig.on_sample(Code(u16::from(bytes.len() as u8) << 4), fits);
        assert!(rig.parameters().check().is_ok());
        true
    });
}

#[test]
fn flash_content() {
    let mut stored =
        Stored { parameters: Parameters::paper().map(|value| value as f32), settings: settings_of_a_rig() };
    let encoded = |stored: &Stored| stored.encode(&mut [0; MAX_STORED]).unwrap().to_vec();
    let without = encoded(&stored);
    let effect = formula::read("-k*omega; k in 0..1").unwrap();
    let mut parameters = Parameters::paper();
    formula::add(&mut parameters, effect, &[0.5]).unwrap();
    stored.parameters = parameters.map(|value| value as f32);
    let seeds = Seeds::new(vec![without, encoded(&stored)]);
    attack("flash content", &seeds, |bytes| {
        let Ok(stored) = Stored::decode(bytes) else { return false };
        let mut rig = Rig::new("fuzz", 4095, Ok(stored));
        rig.on_sample(Code(2000), |_| {});
        true
    });
}

#[test]
fn recordings() {
    let seeds = Seeds::of_folder("recordings");
    let read = |bytes: &[u8]| read_bytes("fuzz.csv", bytes, &ReadOptions::default());
    seeds.all().iter().for_each(|seed| assert!(read(seed).is_ok(), "{:?}", read(seed)));
    attack("recordings", &seeds, |bytes| {
        let Ok(recording) = read(bytes) else { return false };
        assert!(recording.angles_rad().iter().all(|angle| angle.is_finite()));
        assert!(recording.times_s().windows(2).all(|pair| pair[0] < pair[1]));
        true
    });
}

#[test]
fn rig_files() {
    let seeds = Seeds::of_folder("rig_files");
    let parse = |bytes: &[u8]| RigFile::parse("fuzz.toml", &String::from_utf8_lossy(bytes));
    seeds.all().iter().for_each(|seed| drop(parse(seed).unwrap()));
    attack("rig files", &seeds, |bytes| {
        let Ok(file) = parse(bytes) else { return false };
        assert!(file.parameters().check().is_ok());
        let again = parse(file.to_string().as_bytes()).expect("what was read is written readably");
        assert_eq!(again.parameters(), file.parameters());
        true
    });
}

#[test]
fn formulas() {
    let seeds = Seeds::of_folder("formulas");
    let check = |bytes: &[u8]| formula::check(&String::from_utf8_lossy(bytes));
    seeds.all().iter().for_each(|seed| check(seed).unwrap());
    attack("formulas", &seeds, |bytes| check(bytes).is_ok());
}

/// The page's server is made anew after so many requests, or it would be full of models and recordings.
const REQUESTS_PER_SERVER: u32 = 2000;

const ADDRESS: &str = "127.0.0.1:8080";

/// The page with a recording, the first, and a model.
fn page(runtime: &tokio::runtime::Runtime) -> Router {
    let settings = Settings {
        listen: ADDRESS.parse().unwrap(),
        token: None,
        port: None,
        sim_speed: 1.0,
        model: Some((RigFile::new(Parameters::paper().pendulum).unwrap(), "fuzz".to_owned())),
        recordings: Vec::new(),
        folder: "/nowhere".into(),
        reading: ReadOptions::default(),
        segment: Default::default(),
    };
    let page = unplugged(settings);
    let swing = |t: f64| (-0.3 * t).exp() * (8.0 * t).cos();
    let rows: String = (0..400).map(|k| 0.01 * f64::from(k)).map(|t| format!("{t:.2},{:.5}\n", swing(t))).collect();
    let upload = format!("POST /api/recordings?name=first.csv\nt,theta\n{rows}");
    let (status, body) = ask(runtime, &page, upload.as_bytes()).unwrap();
    assert_eq!((status, body.as_slice()), (200, b"1".as_slice()), "{}", String::from_utf8_lossy(&body));
    page
}

/// Asks as the page does: method and path in the first line, the body behind it. `None` if that is no request at all,
/// or one to a rig that is not there.
fn ask(runtime: &tokio::runtime::Runtime, page: &Router, request: &[u8]) -> Option<(u16, Vec<u8>)> {
    let end = request.iter().position(|byte| *byte == b'\n').unwrap_or(request.len());
    let (method, path) = std::str::from_utf8(&request[..end]).ok()?.split_once(' ')?;
    if path.starts_with("/api/rig/") && path != "/api/rig/connect" {
        return None;
    }
    let body = request.get(end + 1..).unwrap_or_default().to_vec();
    let request = Request::builder().method(method).uri(path).header("Host", ADDRESS);
    let request = request.header("Content-Type", "application/json").body(Body::from(body)).ok()?;
    runtime.block_on(async {
        let answer = page.clone().oneshot(request).await.unwrap();
        let status = answer.status().as_u16();
        Some((status, to_bytes(answer.into_body(), usize::MAX).await.unwrap().to_vec()))
    })
}

#[test]
fn requests_of_the_page() {
    let seeds = Seeds::of_folder("requests");
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let (mut server, mut n_asked) = (page(&runtime), 0);
    attack("requests of the page", &seeds, |bytes| {
        n_asked += 1;
        if n_asked % REQUESTS_PER_SERVER == 0 {
            server = page(&runtime);
        }
        let Some((status, body)) = ask(&runtime, &server, bytes) else { return false };
        let text = String::from_utf8_lossy(&body);
        assert!((200..500).contains(&status), "{status}: {text}");
        if (400..500).contains(&status) {
            assert!(text.contains("\"what\":\""), "{status} without a reason: {text}");
        }
        // Where a number is due, there is a number.
        assert!(!text.contains("\"rmse_rad\":null,\"modelled\""), "{text}");
        status < 300
    });
}
