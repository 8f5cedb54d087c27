//! A thousand files of random units, columns and countries whose swing is known: none is read wrongly without a word.

use host::recording::{Measured, ReadOptions, Recording, read_bytes};
use tests::chance::Chance;

const N_FILES: u64 = 1000;

/// What is in a file.
struct Truth {
    times_s: Vec<f64>,
    angles_rad: Vec<f64>,
    rates_rad_s: Vec<f64>,
}

/// A pendulum with dry and viscous friction, by small symplectic steps; ten to twenty swings at 40 to 400 samples each.
fn swing(chance: &mut Chance) -> Truth {
    let gravity = 10f64.powf(chance.within(1.0..2.2));
    let period_s = std::f64::consts::TAU / gravity.sqrt();
    let rate_hz = (chance.within(40.0..200.0) / period_s).round().max(20.0);
    let n_samples = (chance.within(10.0..16.0) * period_s * rate_hz) as usize;
    let amplitude_rad = 10f64.powf(chance.within(-1.3..0.45));
    let (viscous, dry) =
        (chance.within(0.02..0.1) * gravity.sqrt(), chance.within(0.0..0.005) * gravity * amplitude_rad);
    let (mut angle, mut rate) = (amplitude_rad, 0.0_f64);
    let mut truth = Truth { times_s: Vec::new(), angles_rad: Vec::new(), rates_rad_s: Vec::new() };
    let noise = 3e-4 * amplitude_rad;
    for k in 0..n_samples {
        truth.times_s.push(k as f64 / rate_hz);
        truth.angles_rad.push(angle + chance.within(-noise..noise));
        truth.rates_rad_s.push(rate + chance.within(-noise..noise) * gravity.sqrt());
        let dt_s = 1.0 / rate_hz / 8.0;
        for _ in 0..8 {
            let brake = if rate == 0.0 { 0.0 } else { dry * rate.signum() };
            rate += dt_s * (-gravity * angle.sin() - viscous * rate - brake);
            angle += dt_s * rate;
        }
    }
    truth
}

fn one_of<'a, T>(chance: &mut Chance, of: &'a [T]) -> &'a T {
    &of[(chance.within(0.0..1.0) * of.len() as f64) as usize]
}

fn is(chance: &mut Chance, share: f64) -> bool {
    chance.within(0.0..1.0) < share
}

/// Time, angle and rate in five languages.
const WORDS: [[&str; 3]; 7] = [
    ["Time", "Angle", "Angular velocity"],
    ["t", "theta", "omega"],
    ["Zeit", "Winkel", "Winkelgeschwindigkeit"],
    ["Temps", "Angle", "Vitesse angulaire"],
    ["Tiempo", "Ángulo", "Velocidad angular"],
    ["Tempo", "Angolo", "Velocità angolare"],
    ["timestamp", "phi", "gyro z"],
];

/// Units of time: name and seconds.
const TIMES: [(&str, f64); 5] = [("s", 1.0), ("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("min", 60.0)];

/// Units of angles: name and radians.
const ANGLES: [(&str, f64); 7] = [
    ("rad", 1.0),
    ("rad", 1.0),
    ("deg", 0.017_453_292_519_943_295),
    ("°", 0.017_453_292_519_943_295),
    ("mrad", 1e-3),
    ("gon", 0.015_707_963_267_948_967),
    ("turns", std::f64::consts::TAU),
];

/// How numbers are written.
#[derive(Debug, Clone, Copy)]
struct Locale {
    separator: char,
    decimal: char,
    thousands: Option<char>,
    quoted: bool,
}

const LOCALES: [Locale; 9] = [
    Locale { separator: ',', decimal: '.', thousands: None, quoted: false },
    Locale { separator: ',', decimal: '.', thousands: None, quoted: true },
    Locale { separator: ',', decimal: ',', thousands: None, quoted: true },
    Locale { separator: ';', decimal: ',', thousands: None, quoted: false },
    Locale { separator: ';', decimal: ',', thousands: Some('.'), quoted: false },
    Locale { separator: '\t', decimal: '.', thousands: None, quoted: false },
    Locale { separator: '\t', decimal: ',', thousands: Some('\u{a0}'), quoted: false },
    Locale { separator: ' ', decimal: '.', thousands: None, quoted: false },
    Locale { separator: ',', decimal: '.', thousands: Some(','), quoted: true },
];

impl Locale {
    fn write(self, number: f64, digits: usize) -> String {
        let plain = format!("{number:.digits$}");
        let (whole, fraction) = plain.split_once('.').map_or((plain.as_str(), ""), |parts| parts);
        let whole = match self.thousands {
            None => whole.to_owned(),
            Some(mark) => grouped(whole, mark),
        };
        self.dress(&if fraction.is_empty() { whole } else { format!("{whole}{}{fraction}", self.decimal) })
    }

    fn dress(self, cell: &str) -> String {
        if self.quoted { format!("\"{cell}\"") } else { cell.to_owned() }
    }
}

fn grouped(whole: &str, mark: char) -> String {
    let (sign, digits) = whole.strip_prefix('-').map_or(("", whole), |digits| ("-", digits));
    let mut text = String::from(sign);
    for (idx, digit) in digits.chars().enumerate() {
        if idx > 0 && (digits.len() - idx) % 3 == 0 {
            text.push(mark);
        }
        text.push(digit);
    }
    text
}

/// A file, what is to be found in it, and how it was made.
struct File {
    bytes: Vec<u8>,
    truth: Truth,
    /// Rows that have a value.
    kept: Vec<usize>,
    made: String,
}

fn file(seed: u64) -> File {
    let mut chance = Chance::new(seed);
    let chance = &mut chance;
    let truth = swing(chance);
    let words = one_of(chance, &WORDS);
    let (time_unit, seconds) = *one_of(chance, &TIMES);
    let (angle_unit, radians) = *one_of(chance, &ANGLES);
    let locale = *one_of(chance, &LOCALES);
    let (has_head, states_units, states_time) = (is(chance, 0.85), is(chance, 0.75), is(chance, 0.8));
    let only_rates = is(chance, 0.1);
    let is_clock = is(chance, 0.1) && locale.separator != ' ' && locale.decimal == '.';
    let since_1970 = !is_clock && seconds < 60.0 && is(chance, 0.1);
    let zero_rad =
        *one_of(chance, &[0.0, 0.0, 0.0, 0.0, 0.03, -0.05, -std::f64::consts::FRAC_PI_2, std::f64::consts::PI]);
    let wraps = is(chance, 0.3);
    let wrapped = |angle: f64| {
        if wraps {
            (angle + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
        } else {
            angle
        }
    };
    let missing = if is(chance, 0.15) { *one_of(chance, &["", "NaN", "NA"]) } else { "0" };
    let angle_first = has_head && is(chance, 0.2);
    let bracket = |name: &str, unit: &str, stated: bool| {
        if stated && has_head { format!("{name} [{unit}]") } else { name.to_owned() }
    };
    let space = locale.separator == ' ';
    let rate_unit = format!("{angle_unit}/s");
    let names = [
        bracket(words[0], time_unit, states_time && !is_clock),
        bracket(words[1], angle_unit, states_units),
        bracket(words[2], &rate_unit, states_units || words[2].contains(' ')),
    ];
    let time_digits =
        if since_1970 { (5.0 + seconds.log10()).max(0.0) } else { (7.0 + seconds.log10()).max(1.0) } as usize;
    let angle_digits = (6.0 + radians.log10().ceil()).max(1.0) as usize;
    let time = |time_s: f64| match is_clock {
        true => locale.dress(&format!("12:{:02}:{:09.6}", (time_s / 60.0) as u32, time_s % 60.0)),
        false => locale.write((time_s + if since_1970 { 1_772_366_400.0 } else { 0.0 }) / seconds, time_digits),
    };
    let mut text = String::new();
    if is(chance, 0.2) {
        text += "# made by a logger\n";
    }
    let columns = |cells: [String; 3]| -> Vec<String> {
        let [time, angle, rate] = cells;
        match (only_rates, angle_first, has_head && !space) {
            (true, ..) => vec![time, rate],
            (_, true, _) => vec![angle, time],
            (_, _, true) => vec![time, angle, rate],
            _ => vec![time, angle],
        }
    };
    let separator = locale.separator.to_string();
    if has_head {
        text += &(columns(names.map(|name| locale.dress(&if space { name.replace(' ', "_") } else { name })))
            .join(&separator)
            + "\n");
    }
    let mut kept = Vec::new();
    for idx in 0..truth.times_s.len() {
        let is_missing = missing != "0" && !space && is(chance, 0.03);
        let angle = wrapped(truth.angles_rad[idx] + zero_rad) / radians;
        let angle = if is_missing { locale.dress(missing) } else { locale.write(angle, angle_digits) };
        if !is_missing || only_rates {
            kept.push(idx);
        }
        let cells = [time(truth.times_s[idx]), angle, locale.write(truth.rates_rad_s[idx] / radians, angle_digits)];
        text += &(columns(cells).join(&separator) + "\n");
    }
    let bytes = match one_of(chance, &[0, 0, 1, 2]) {
        0 => text.into_bytes(),
        1 => text.replace('\n', "\r\n").into_bytes(),
        _ => format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect(),
    };
    let amplitude = truth.angles_rad[0];
    let made = format!(
        "seed {seed}: {words:?}, {time_unit} (told {states_time}), {angle_unit} (told {states_units}), {locale:?}, head \
         {has_head}, rates {only_rates}, clock {is_clock}, 1970 {since_1970}, zero {zero_rad:.2}, wraps {wraps}, missing \
         {missing:?}, amplitude {amplitude:.3} rad"
    );
    File { bytes, truth, kept, made }
}

/// Largest distances from the truth: of the time, in steps; of the angle, as a share of the amplitude, but for the zero.
fn off(recording: &Recording, file: &File) -> Option<(f64, f64)> {
    let File { truth, kept, .. } = file;
    if recording.len() != kept.len() {
        return None;
    }
    let step_s = truth.times_s[1];
    let begin_s = recording.times_s()[0] - truth.times_s[kept[0]];
    let pairs = || kept.iter().enumerate().map(|(read, idx)| (read, *idx));
    let is_rate = recording.measured() == Measured::Rate;
    let wanted = if is_rate { &truth.rates_rad_s } else { &truth.angles_rad };
    let zero = pairs().map(|(read, idx)| recording.angles_rad()[read] - wanted[idx]).sum::<f64>() / kept.len() as f64;
    let time = |(read, idx): (usize, usize)| (recording.times_s()[read] - begin_s - truth.times_s[idx]).abs() / step_s;
    let angle = |(read, idx): (usize, usize)| (recording.angles_rad()[read] - zero - wanted[idx]).abs();
    let zero_is_off = zero.abs() > 0.1;
    let angle =
        pairs().map(angle).fold(0.0, f64::max) / wanted.iter().fold(0.0, |largest, reading| reading.abs().max(largest));
    Some((pairs().map(time).fold(0.0, f64::max), if zero_is_off { f64::INFINITY } else { angle }))
}

#[test]
fn no_file_of_a_thousand_is_read_wrongly_without_a_word() {
    let (mut n_right, mut n_refused, mut n_doubted) = (0, 0, 0);
    let mut wrong = Vec::new();
    for seed in 0..N_FILES {
        let file = file(seed);
        let recording = match read_bytes("random.csv", &file.bytes, &ReadOptions::default()) {
            Ok(recording) => recording,
            Err(error) => {
                n_refused += 1;
                assert!(error.to_string().contains("random.csv"), "{error}");
                if std::env::var_os("SHOW_REFUSED").is_some() {
                    println!("{error}\n  {}", file.made);
                }
                continue;
            }
        };
        // A twentieth of a step and of a percent is what the printed digits leave.
        let is_right = off(&recording, &file).is_some_and(|(time, angle)| time < 0.05 && angle < 0.005);
        match (is_right, recording.notes().is_empty()) {
            (true, _) => n_right += 1,
            (false, false) => n_doubted += 1,
            (false, true) => wrong.push(format!("{:?} {}", off(&recording, &file), file.made)),
        }
    }
    println!(
        "{n_right} read rightly, {n_refused} refused, {n_doubted} read with a word of doubt, {} wrong",
        wrong.len()
    );
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(n_right > N_FILES / 2, "{n_right}");
}
