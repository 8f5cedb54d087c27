//! The page docs/protocol.md: a written part, and tables that are read off the types of [`shared::wire`].

use serde::de::DeserializeOwned;
use serde_reflection::{ContainerFormat, Format, FormatHolder, Named, Registry, Tracer, TracerConfig, VariantFormat};
use shared::bank::findings::Reason;
use shared::curve::MAX_KNOTS;
use shared::effect::{Effect, MAX_VALUES, Parameter};
use shared::formula::MAX_BYTES;
use shared::parameters::{MAX_EFFECTS, ParameterError};
use shared::rig::{HIGHEST_BANDWIDTH_RAD_S, HIGHEST_CUTOFF, HIGHEST_RATE_HZ, LOWEST_RATE_HZ};
use shared::sensor::{Encoder, Potentiometer, Sensor};
use shared::wire::{
    Answer, Chip, Clock, Command, Frame, Health, Hello, MAX_FRAME, MAX_SUSPECTS, POINTS_PER_FRAME, PROTOCOL, Refusal,
    ResetCause, SAMPLES_PER_FRAME, StoreState, Stream, encode,
};
use std::fmt::Write;

/// What the tables can't say.
const WRITTEN: &str = include_str!("protocol_page.md");

/// The page as it should be.
pub fn page() -> String {
    let registry = registry();
    let mut text = WRITTEN.replace("PROTOCOL_VERSION", &PROTOCOL.to_string());
    text += "\n## Frames as bytes\n\n| frame | bytes on the wire, in hexadecimal |\n|---|---|\n";
    for (what, frame) in examples() {
        let mut buffer = [0; MAX_FRAME];
        let bytes = encode(&frame, &mut buffer).expect("short frames");
        let hexadecimal: Vec<String> = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        let _ = writeln!(text, "| {what} | `{}` |", hexadecimal.join(" "));
    }
    text += "\n## Limits\n\n";
    text += &limits();
    text += "\n## Effects\n\n";
    text += &effects();
    text += "\n## Types\n";
    for name in in_order(&registry) {
        text += &container(&name, &registry[&name]);
    }
    text
}

fn examples() -> Vec<(&'static str, Frame)> {
    let hello = Hello { catalogue: 0, version: [0, 1, 0], ..Hello::new("python") };
    vec![
        ("`Hello` of a program called python 0.1.0 that does not tell its effects", Frame::Hello(hello)),
        ("command 1, `GetSettings`", Frame::Command(1, Command::GetSettings)),
        ("command 2, `Start` raw samples", Frame::Command(2, Command::Start(Stream { raw: true, live_every: 0 }))),
        ("command 300, `Stop`", Frame::Command(300, Command::Stop)),
    ]
}

/// What the types can hold at most, and between which values settings are taken.
fn limits() -> String {
    let lists = [
        ("codes of Samples", SAMPLES_PER_FRAME),
        ("points of Live", POINTS_PER_FRAME),
        ("effects of Numbers", MAX_EFFECTS),
        ("values of EffectValues; values and stds of Suspected", MAX_VALUES),
        ("bytes of CustomFormula", MAX_BYTES),
        ("knots of FrictionCurve", MAX_KNOTS),
        ("suspects of Suspects", MAX_SUSPECTS),
    ];
    let texts = [
        ("name of Hello", Hello::new("").name.capacity()),
        ("serial of Chip", Chip::default().serial.capacity()),
        ("last_fault of Health", Health::default().last_fault.capacity()),
    ];
    let mut text = "| list or text | at most |\n|---|---|\n".to_owned();
    lists.iter().for_each(|(what, limit)| text += &format!("| {what} | {limit} |\n"));
    texts.iter().for_each(|(what, limit)| text += &format!("| {what} | {limit} bytes |\n"));
    text += "\n| setting | range |\n|---|---|\n";
    let _ = writeln!(text, "| rate_hz | {LOWEST_RATE_HZ} to {HIGHEST_RATE_HZ} |");
    let _ = writeln!(text, "| cutoff_hz | more than 0, at most {HIGHEST_CUTOFF} · rate_hz |");
    let _ = writeln!(text, "| bandwidth_rad_s | 0 to {HIGHEST_BANDWIDTH_RAD_S} |");
    let expected = |of: Sensor| of.expected().trim_start_matches("expected ");
    let _ = writeln!(text, "| sensor, a potentiometer | {} |", expected(Potentiometer::nominal(4095).into()));
    let _ = writeln!(text, "| sensor, an encoder | {} |", expected(Encoder::new(4096).into()));
    text + "\nA rig refuses settings outside their range and a potentiometer whose full_scale is not that of its converter, and a\n\
            program a rig that says it had settings outside their range.\n"
}

/// The effects of the list, with the order of their values.
fn effects() -> String {
    let mut text = "| id | effect | values, in this order |\n|---|---|---|\n".to_owned();
    for effect in Effect::<f64>::ALL {
        let value = |number: &Parameter| format!("{} ({})", number.symbol, number.unit);
        let values: Vec<String> = effect.parameters.iter().map(value).collect();
        let _ = writeln!(text, "| {} | {} | {} |", effect.id, effect.name, values.join(", "));
    }
    text + "\nWhat each of them is stands in [effects.md](effects.md). An effect that is not listed in `Numbers` does not act.\n"
}

fn registry() -> Registry {
    let mut tracer = Tracer::new(TracerConfig::default());
    // Enums within enums are followed one at a time, the innermost first.
    trace::<ParameterError>(&mut tracer);
    trace::<Refusal>(&mut tracer);
    trace::<ResetCause>(&mut tracer);
    trace::<StoreState>(&mut tracer);
    trace::<Clock>(&mut tracer);
    trace::<Reason>(&mut tracer);
    trace::<Sensor>(&mut tracer);
    trace::<Answer>(&mut tracer);
    trace::<Command>(&mut tracer);
    trace::<Frame>(&mut tracer);
    tracer.registry().expect("every variant was seen")
}

fn trace<T: DeserializeOwned>(tracer: &mut Tracer) {
    tracer.trace_simple_type::<T>().expect("plain types");
}

/// Each type after the first that uses it, as a reader meets them.
fn in_order(registry: &Registry) -> Vec<String> {
    let mut names = vec!["Frame".to_owned()];
    let mut at = 0;
    while at < names.len() {
        let mut used = Vec::new();
        collect(&registry[&names[at]], &mut used);
        for name in used {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        at += 1;
    }
    names
}

fn collect(container: &ContainerFormat, used: &mut Vec<String>) {
    let _ = container.visit(&mut |format| {
        if let Format::TypeName(name) = format {
            used.push(name.clone());
        }
        Ok(())
    });
}

fn container(name: &str, container: &ContainerFormat) -> String {
    let mut text = format!("\n### {name}\n\n");
    match container {
        ContainerFormat::Enum(variants) => {
            text += "| number | variant | content |\n|---|---|---|\n";
            for (number, variant) in variants {
                let _ = writeln!(text, "| {number} | {} | {} |", variant.name, content(&variant.value));
            }
        }
        ContainerFormat::Struct(fields) => {
            text += "| field | type |\n|---|---|\n";
            for field in fields {
                let _ = writeln!(text, "| {} | {} |", field.name, type_name(&field.value));
            }
        }
        ContainerFormat::NewTypeStruct(format) => {
            let _ = writeln!(text, "{}, nothing else.", type_name(format));
        }
        ContainerFormat::TupleStruct(formats) => {
            let _ = writeln!(text, "{}.", list(formats));
        }
        ContainerFormat::UnitStruct => text += "Nothing.\n",
    }
    text
}

fn content(variant: &VariantFormat) -> String {
    match variant {
        VariantFormat::Unit | VariantFormat::Variable(_) => "—".to_owned(),
        VariantFormat::NewType(format) => type_name(format),
        VariantFormat::Tuple(formats) => list(formats),
        VariantFormat::Struct(fields) => {
            let field = |field: &Named<Format>| format!("{}: {}", field.name, type_name(&field.value));
            fields.iter().map(field).collect::<Vec<_>>().join(", ")
        }
    }
}

fn list(formats: &[Format]) -> String {
    formats.iter().map(type_name).collect::<Vec<_>>().join(", ")
}

fn type_name(format: &Format) -> String {
    match format {
        Format::TypeName(name) => format!("[{name}](#{})", name.to_lowercase()),
        Format::Seq(item) => format!("list of {}", type_name(item)),
        Format::TupleArray { content, size } => format!("{size} × {}", type_name(content)),
        Format::Tuple(formats) => list(formats),
        Format::Option(value) => format!("optional {}", type_name(value)),
        Format::Str => "text".to_owned(),
        other => format!("{other:?}").to_lowercase(),
    }
}
