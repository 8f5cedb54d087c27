//! The frame of a Python module around the formulas.

use super::print::{body, without_parentheses};
use super::trace::{Function, Trace};
use super::{Language, Number};
use shared::model::MAX_CUTS;

/// The whole module.
pub(super) fn module(numbers: &[Number], trace: &Trace, laws: &[String]) -> String {
    let numbers: String = numbers.iter().map(|n| format!("{} = {:?}  # {}\n", n.name, n.value, n.comment())).collect();
    [
        top(laws),
        numbers,
        HELPERS.to_owned(),
        class("State", &trace.state),
        class("Sensor", &trace.sensor),
        functions(trace),
    ]
    .join("\n")
}

fn top(laws: &[String]) -> String {
    let laws: String = laws.iter().map(|law| format!("    {law}\n")).collect();
    format!(
        "\
\"\"\"A pendulum's model, written by `host export --format python`. Needs nothing but Python 3. SI units and radians,
angle 0 hanging, counter-clockwise positive.

{laws}
    state = release(1.5)            # let go at 1.5 rad
    step(state, 0.001)              # 1 ms later: state.angle_rad, state.velocity_rad_s
    friction_nm(state)              # friction and all added effects at present, N·m
    sensor = sensor_at_rest(state)  # before the first reading
    read(state, sensor)             # what the sensor shows, rad; once a sample

Change the numbers below as you like; the formulas hold for any.
\"\"\"

import math
"
    )
}

/// Python stops where other languages go on with infinity or not-a-number, and formulas that are not used may be both.
const HELPERS: &str = "
def _divide(a, b):
    if b != 0.0:
        return a / b
    return math.nan if a == 0.0 or a != a else math.copysign(math.inf, a) * math.copysign(1.0, b)


def _sin(a):
    return math.sin(a) if math.isfinite(a) else math.nan


def _sqrt(a):
    return math.sqrt(a) if a >= 0.0 else math.nan


def _exp(a):
    return math.exp(a) if not a > 709.0 else math.inf


def _log(a):
    return math.log(a) if a > 0.0 else (-math.inf if a == 0.0 else math.nan)


def _pow(a, b):
    if a > 0.0 or (a == 0.0 and b >= 0.0):
        return a**b
    return math.inf if a == 0.0 else math.nan

";

fn class(name: &str, fields: &[String]) -> String {
    let slots: String = fields.iter().map(|field| format!("\"{field}\", ")).collect();
    format!("\nclass {name}:\n    __slots__ = ({slots})\n\n")
}

fn functions(trace: &Trace) -> String {
    let mut text = String::new();
    text +=
        "\ndef release(angle_rad, velocity_rad_s=0.0):\n    \"\"\"Lets the pendulum go.\"\"\"\n    state = State()\n";
    text += &lines(&trace.release, &[("state", &[])]);
    text += "    return state\n\n";

    text += "\ndef _slide(state, dt_s, always):\n    \"\"\"Steps in one piece, always or if nothing changes.\"\"\"\n";
    text += &lines(&trace.slide, &[("state", &trace.state)]);
    text += "    return True\n\n";

    text += "\ndef _step_to_change(state, dt_s):\n";
    text += "    \"\"\"Steps until sliding begins or ends, at most dt_s; gives what is left of it.\"\"\"\n";
    text += &lines(&trace.step_to_change, &[("state", &trace.state)]);
    text += "    return result\n\n";

    text += &format!(
        "
def step(state, dt_s):
    \"\"\"Advances by dt_s seconds, a few ms at most.\"\"\"
    if _slide(state, dt_s, False):
        return
    for _ in range({MAX_CUTS}):
        if dt_s <= 0.0:
            return
        dt_s = _step_to_change(state, dt_s)
    if dt_s > 0.0:
        _slide(state, dt_s, True)

"
    );
    text += "\ndef friction_nm(state):\n    \"\"\"Friction and all added effects at present, in N·m.\"\"\"\n";
    text += &lines(&trace.friction, &[("state", &trace.state)]);
    text += "    return result\n\n";

    text +=
        "\ndef sensor_at_rest(state):\n    \"\"\"The sensor on a pendulum that is held still in this state.\"\"\"\n";
    text += "    sensor = Sensor()\n";
    text += &lines(&trace.sensor_at_rest, &[("state", &trace.state), ("sensor", &[])]);
    text += "    return sensor\n\n";

    text +=
        "\ndef read(state, sensor):\n    \"\"\"What the sensor shows, in rad. Call it at each sample in turn.\"\"\"\n";
    text += &lines(&trace.read, &[("state", &trace.state), ("sensor", &trace.sensor)]);
    text += "    return result\n";
    text
}

/// The body of a function: given fields, formulas, fields set. The last structure is the one that is set.
fn lines(function: &Function, structures: &[(&str, &[String])]) -> String {
    let body = body(function, Language::Python);
    let mut lines = Vec::new();
    for (structure, fields) in structures {
        let used = fields.iter().filter(|field| body.inputs.contains(field));
        lines.extend(used.map(|field| format!("{field} = {structure}.{field}")));
    }
    lines.extend(body.before);
    lines.extend(body.condition.map(|condition| format!("if not (always or {condition}):\n        return False")));
    lines.extend(body.after);
    lines.extend(body.result.map(|result| format!("result = {}", without_parentheses(&result))));
    let set = structures.last().map_or("state", |(structure, _)| structure);
    let is_new = structures.last().is_some_and(|(_, fields)| fields.is_empty());
    let outputs = body.outputs.iter().filter(|(name, value)| is_new || name != value);
    lines.extend(outputs.map(|(name, value)| format!("{set}.{name} = {}", without_parentheses(value))));
    lines.into_iter().map(|line| format!("    {line}\n")).collect()
}
