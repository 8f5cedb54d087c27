//! The frame of a MATLAB file around the formulas: one function that is a script's, Octave's and a MATLAB Function block's.

use super::print::{body, without_parentheses};
use super::trace::{Function, Trace};
use super::{Language, Number};
use shared::model::MAX_CUTS;

/// The whole file.
pub(super) fn function_file(numbers: &[Number], trace: &Trace, laws: &[String]) -> String {
    [top(laws), self::numbers(numbers), functions(trace), HELPERS.to_owned()].join("\n")
}

fn top(laws: &[String]) -> String {
    let laws: String = laws.iter().map(|law| format!("%   {law}\n")).collect();
    format!(
        "\
function [angle_rad, velocity_rad_s, reading_rad, torque_nm] = rig(start, dt_s)
%#codegen
% A pendulum's model, written by `host export --format matlab`. Runs in MATLAB, in Octave, and as a MATLAB Function block
% of Simulink with a fixed step. SI units and radians, angle 0 hanging, counter-clockwise positive.
%
{laws}%
%   rig([1.5 0], 0);                                lets it go at 1.5 rad, at rest
%   [angle_rad, velocity_rad_s] = rig([1.5 0], 1e-3);   a millisecond later, and so on with each call
%
% The first call, and any with dt_s = 0, lets it go; every other advances by dt_s seconds, a few ms at most. reading_rad
% is what the sensor shows, torque_nm friction and all added effects. Change the numbers below as you like.
persistent state sensor
if isempty(state)
    state = rig_release(start(1), start(2));
    sensor = rig_sensor_at_rest(state);
elseif dt_s == 0
    state = rig_release(start(1), start(2));
    sensor = rig_sensor_at_rest(state);
else
    state = rig_step(state, dt_s);
end
[sensor, reading_rad] = rig_read(state, sensor);
torque_nm = rig_friction_nm(state);
angle_rad = state.angle_rad;
velocity_rad_s = state.velocity_rad_s;
end
"
    )
}

fn numbers(numbers: &[Number]) -> String {
    let lines: String = numbers.iter().map(|n| format!("p.{} = {:?}; % {}\n", n.name, n.value, n.comment())).collect();
    format!("function p = rig_numbers()\n{lines}end\n")
}

/// What MATLAB would make complex numbers of is not used, but must not be one; and both sides of a choice are computed.
const HELPERS: &str = "\
function c = rig_choose(condition, a, b)
if condition
    c = a;
else
    c = b;
end
end

function b = rig_sqrt(a)
b = NaN;
if a >= 0
    b = sqrt(a);
end
end

function b = rig_log(a)
b = NaN;
if a >= 0
    b = log(a);
end
end

function c = rig_pow(a, b)
c = NaN;
if a >= 0
    c = a^b;
end
end
";

fn functions(trace: &Trace) -> String {
    let state = ("state", &trace.state[..]);
    let sensor = ("sensor", &trace.sensor[..]);
    let step = format!(
        "\
function state = rig_step(state, dt_s)
[state, done] = rig_slide(state, dt_s, false);
if done
    return
end
for cut = 1:{MAX_CUTS}
    if dt_s > 0
        [state, dt_s] = rig_step_to_change(state, dt_s);
    end
end
if dt_s > 0
    state = rig_slide(state, dt_s, true);
end
end
"
    );
    [
        function("state = rig_release(angle_rad, velocity_rad_s)", &trace.release, &[], Some(("state", &trace.state))),
        function("[state, done] = rig_slide(state, dt_s, always)", &trace.slide, &[state], Some(state)),
        function("[state, result] = rig_step_to_change(state, dt_s)", &trace.step_to_change, &[state], Some(state)),
        step,
        function("result = rig_friction_nm(state)", &trace.friction, &[state], None),
        function("sensor = rig_sensor_at_rest(state)", &trace.sensor_at_rest, &[state], Some(sensor)),
        function("[sensor, result] = rig_read(state, sensor)", &trace.read, &[state, sensor], Some(sensor)),
    ]
    .join("\n")
}

/// One function: given fields, formulas, fields set. A structure that is given nothing is new, and has all its fields.
fn function(head: &str, function: &Function, given: &[(&str, &[String])], set: Option<(&str, &[String])>) -> String {
    let body = body(function, Language::Matlab);
    let mut lines = vec!["p = rig_numbers(); %#ok<NASGU>".to_owned()];
    for (structure, fields) in given {
        let used = fields.iter().filter(|field| body.inputs.contains(field));
        lines.extend(used.map(|field| format!("{field} = {structure}.{field};")));
    }
    lines.extend(body.before);
    if head.contains("done") {
        let condition = body.condition.unwrap_or_else(|| "true".to_owned());
        lines.push(format!("done = always || {condition};\nif ~done\n    return\nend"));
    }
    lines.extend(body.after);
    lines.extend(body.result.map(|result| format!("result = {};", without_parentheses(&result))));
    if let Some((structure, fields)) = set {
        let is_new = given.iter().all(|(name, _)| *name != structure);
        if is_new && fields.is_empty() {
            lines.push(format!("{structure} = struct('nothing', 0);"));
        }
        let outputs = body.outputs.iter().filter(|(name, value)| is_new || name != value);
        lines.extend(outputs.map(|(name, value)| format!("{structure}.{name} = {};", without_parentheses(value))));
    }
    format!("function {head}\n{}\nend\n", lines.join("\n"))
}
