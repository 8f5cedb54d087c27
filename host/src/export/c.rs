//! The frame of a C99 header around the formulas: with the model's numbers as definitions, or, where each of several
//! pendulums has its own, in a structure that every function is given.

use super::print::{PREFIX, body, without_parentheses};
use super::trace::{Function, Trace};
use super::{Language, Number};
use shared::model::MAX_CUTS;

/// Where functions find the model's numbers.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Numbers {
    Defined,
    Given,
}

impl Numbers {
    /// The parameter that a function has for them, before others.
    fn parameter(self) -> &'static str {
        if self == Self::Given { "const rig_numbers *numbers, " } else { "" }
    }

    /// The same where it is called.
    fn argument(self) -> &'static str {
        if self == Self::Given { "numbers, " } else { "" }
    }

    fn text(self, numbers: &[Number]) -> String {
        match self {
            Self::Defined => numbers.iter().map(define).collect(),
            Self::Given => given(numbers),
        }
    }

    fn top(self, laws: &[String]) -> String {
        if self == Self::Given { top_of_given(laws) } else { top(laws) }
    }
}

/// The whole header.
pub(super) fn header(numbers: &[Number], trace: &Trace, laws: &[String], place: Numbers) -> String {
    [
        place.top(laws),
        place.text(numbers),
        structure(
            "rig_state",
            "Between two steps. Slide, push and level tell sliding, creeping and rest.",
            &trace.state,
        ),
        structure("rig_sensor", "What the sensor remembers.", &trace.sensor),
        functions(trace, place),
        "#endif\n".to_owned(),
    ]
    .join("\n")
}

fn listed(laws: &[String]) -> String {
    laws.iter().map(|law| format!("     {law}\n")).collect()
}

fn top_of_given(laws: &[String]) -> String {
    format!(
        "\
/* A pendulum's model: its effects, the numbers that it usually has, and how it moves. C99; needs nothing but <math.h>.
   SI units and radians, angle 0 hanging, counter-clockwise positive.

{laws} */
#ifndef RIG_H
#define RIG_H

#include <math.h>
",
        laws = listed(laws)
    )
}

fn top(laws: &[String]) -> String {
    let laws = listed(laws);
    format!(
        "\
/* A pendulum's model, written by `host export --format c`. C99; needs nothing but <math.h>. SI units and radians,
   angle 0 hanging, counter-clockwise positive.

{laws}
     rig_state state = rig_release(1.5, 0.0);        let go at 1.5 rad
     rig_step(&state, 0.001);                        1 ms later: state.angle_rad, state.velocity_rad_s
     double torque = rig_friction_nm(&state);        friction and all added effects at present, N*m
     rig_sensor sensor = rig_sensor_at_rest(&state); before the first reading
     double reading = rig_read(&state, &sensor);     what the sensor shows, rad; once a sample

   Change the numbers below as you like; the formulas hold for any. */
#ifndef RIG_H
#define RIG_H

#include <math.h>
"
    )
}

fn define(number: &Number) -> String {
    format!("#define {PREFIX}{} {:?} /* {} */\n", number.name, number.value, number.comment())
}

fn given(numbers: &[Number]) -> String {
    let of_all = |line: fn(&Number) -> String| numbers.iter().map(line).collect::<String>();
    let fields = of_all(|number| format!("    double {}; /* {} */\n", number.name, number.comment()));
    let values = of_all(|number| format!("    {:?},\n", number.value));
    let names = of_all(|number| format!("#define {PREFIX}{name} (numbers->{name})\n", name = number.name));
    format!(
        "typedef struct {{\n{fields}}} rig_numbers;\n\nstatic const rig_numbers rig_usual = {{\n{values}}};\n\n{names}"
    )
}

fn structure(name: &str, what: &str, fields: &[String]) -> String {
    let fields = if fields.is_empty() { vec!["nothing".to_owned()] } else { fields.to_vec() };
    let lines: String = fields.iter().map(|field| format!("    double {field};\n")).collect();
    format!("/* {what} */\ntypedef struct {{\n{lines}}} {name};\n")
}

fn functions(trace: &Trace, place: Numbers) -> String {
    let (parameter, argument) = (place.parameter(), place.argument());
    let lines = |function: &Function, structures: &[(&str, &[String])]| {
        let unused = if place == Numbers::Given { "    (void)numbers;\n" } else { "" };
        unused.to_owned() + &lines(function, structures)
    };
    let mut text = String::new();
    text += "/* Lets the pendulum go. */\n";
    text += &format!("static inline rig_state rig_release({parameter}double angle_rad, double velocity_rad_s) {{\n");
    text += "    rig_state after;\n    rig_state *state = &after;\n";
    text += &lines(&trace.release, &[("state", &[])]);
    text += "    return after;\n}\n\n";

    text += "/* Steps in one piece, always or if nothing changes; gives whether it did. */\n";
    text += &format!("static inline int rig_slide({parameter}rig_state *state, double dt_s, int always) {{\n");
    text += &lines(&trace.slide, &[("state", &trace.state)]);
    text += "    return 1;\n}\n\n";

    text += "/* Steps until sliding begins or ends, at most dt_s; gives what is left of it. */\n";
    text += &format!("static inline double rig_step_to_change({parameter}rig_state *state, double dt_s) {{\n");
    text += &lines(&trace.step_to_change, &[("state", &trace.state)]);
    text += "    return rig_result;\n}\n\n";

    text += &format!(
        "\
/* Advances by dt_s seconds, a few ms at most. */
static inline void rig_step({parameter}rig_state *state, double dt_s) {{
    int n_cuts;
    if (rig_slide({argument}state, dt_s, 0)) return;
    for (n_cuts = 0; n_cuts < {MAX_CUTS} && dt_s > 0.0; n_cuts++) dt_s = rig_step_to_change({argument}state, dt_s);
    if (dt_s > 0.0) rig_slide({argument}state, dt_s, 1);
}}

"
    );
    text += "/* Friction and all added effects at present, in N*m; at rest what the bearing holds. */\n";
    text += &format!("static inline double rig_friction_nm({parameter}const rig_state *state) {{\n");
    text += &lines(&trace.friction, &[("state", &trace.state)]);
    text += "    return rig_result;\n}\n\n";

    text += "/* The sensor on a pendulum that is held still in this state. */\n";
    text += &format!("static inline rig_sensor rig_sensor_at_rest({parameter}const rig_state *state) {{\n");
    text += "    rig_sensor after = {0};\n    rig_sensor *sensor = &after;\n";
    text += &lines(&trace.sensor_at_rest, &[("state", &trace.state), ("sensor", &[])]);
    text += "    (void)state;\n    (void)sensor;\n    return after;\n}\n\n";

    text += "/* What the sensor shows, in rad. Call it at each sample in turn: some sensors remember. */\n";
    text += &format!("static inline double rig_read({parameter}const rig_state *state, rig_sensor *sensor) {{\n");
    text += &lines(&trace.read, &[("state", &trace.state), ("sensor", &trace.sensor)]);
    text += "    (void)sensor;\n    return rig_result;\n}\n";
    text
}

/// The body of a function: given fields, formulas, fields set. The last structure is the one that is set.
fn lines(function: &Function, structures: &[(&str, &[String])]) -> String {
    let body = body(function, Language::C);
    let mut lines = Vec::new();
    for (structure, fields) in structures {
        let used = fields.iter().filter(|field| body.inputs.contains(field));
        lines.extend(used.map(|field| format!("const double {field} = {structure}->{field};")));
    }
    lines.extend(body.before);
    lines.extend(body.condition.map(|condition| format!("if (!(always || {condition})) return 0;")));
    lines.extend(body.after);
    lines.extend(body.result.map(|result| format!("const double rig_result = {};", without_parentheses(&result))));
    let set = structures.last().map_or("state", |(structure, _)| structure);
    let is_new = structures.last().is_some_and(|(_, fields)| fields.is_empty());
    let outputs = body.outputs.iter().filter(|(name, value)| is_new || name != value);
    lines.extend(outputs.map(|(name, value)| format!("{set}->{name} = {};", without_parentheses(value))));
    lines.into_iter().map(|line| format!("    {line}\n")).collect()
}
