//! Runs the model with symbols: one function of the model, one list of formulas.

use super::symbol::{Graph, Node, Symbol, Truth, written_by};
use crate::formula::effect_of;
use crate::rigfile::Quantity;
use shared::model::{Model, SensorState, State};
use shared::motion::Pendulum;
use shared::parameters::{EffectValues, Parameters};

/// The slots of a state by name; those after the sixth are the memories.
const STATE: [&str; 6] = ["angle_rad", "velocity_rad_s", "time_s", "slide", "push", "level_nm"];

/// A function of the model as formulas.
pub(super) struct Function {
    pub(super) graph: Graph,
    /// What it gives besides the state.
    pub(super) result: Option<Symbol>,
    /// The state after it, as name and formula.
    pub(super) outputs: Vec<(String, Symbol)>,
    /// It holds only where this is true.
    pub(super) condition: Option<Truth>,
}

/// All functions of one model.
pub(super) struct Trace {
    /// Names of the numbers in a state.
    pub(super) state: Vec<String>,
    /// Names of the numbers that the sensor remembers.
    pub(super) sensor: Vec<String>,
    pub(super) release: Function,
    /// A step in which nothing changes.
    pub(super) slide: Function,
    /// A step until something changes; gives what is left of it.
    pub(super) step_to_change: Function,
    pub(super) friction: Function,
    pub(super) sensor_at_rest: Function,
    pub(super) read: Function,
}

impl Trace {
    /// `None` if the way of the program depends on the numbers in more than the one place that is known.
    pub(super) fn of(parameters: &Parameters<f64>) -> Option<Self> {
        let mut release = function(None, || {
            let state = model(parameters).release(Symbol::named("angle_rad"), Symbol::named("velocity_rad_s"));
            (None, state_after(&state))
        })?;
        let mut slide = function(Some(()), || {
            let (mut state, dt_s) = (given_state(), Symbol::named("dt_s"));
            model(parameters).step(&mut state, dt_s);
            (None, state_after(&state))
        })?;
        let mut step_to_change = function(None, || {
            let (mut state, dt_s) = (given_state(), Symbol::named("dt_s"));
            let left_s = model(parameters).step_to_change(&mut state, dt_s);
            (Some(left_s), state_after(&state))
        })?;
        let friction = function(None, || (Some(model(parameters).friction_torque_nm(&given_state())), Vec::new()))?;
        let mut sensor_at_rest = function(None, || {
            let sensor = model(parameters).sensor_at_rest(&given_state());
            (None, sensor_after(&sensor))
        })?;
        let mut read = function(None, || {
            let mut sensor = given_sensor();
            let reading = model(parameters).read(&given_state(), &mut sensor);
            (Some(reading), sensor_after(&sensor))
        })?;
        let state = used_slots(&mut [&mut release, &mut slide, &mut step_to_change]);
        let sensor = used_slots(&mut [&mut sensor_at_rest, &mut read]);
        Some(Self { state, sensor, release, slide, step_to_change, friction, sensor_at_rest, read })
    }
}

/// Runs one function; with `may_ask` its first question is the condition under which its formulas hold.
fn function(
    may_ask: Option<()>,
    program: impl FnOnce() -> (Option<Symbol>, Vec<(String, Symbol)>),
) -> Option<Function> {
    let ((result, outputs), graph) = written_by(program);
    let condition = graph.questions.first().copied();
    let n_allowed = usize::from(may_ask.is_some());
    (graph.questions.len() <= n_allowed).then_some(Function { graph, result, outputs, condition })
}

/// The model with every number by its name.
fn model(parameters: &Parameters<f64>) -> Model<Symbol> {
    let named = |quantity: Quantity| Symbol::named(&name_of(quantity));
    let pendulum = Pendulum {
        mass_kg: named(Quantity::Mass),
        length_m: named(Quantity::Length),
        inertia_kg_m2: named(Quantity::Inertia),
        gravity_m_s2: named(Quantity::Gravity),
    };
    let with_names = |present: &EffectValues<f64>| {
        let quantities = effect_of(parameters, present.id).into_iter().flat_map(Quantity::all_of_effect);
        EffectValues { id: present.id, values: quantities.map(named).collect() }
    };
    let effects = parameters.effects.iter().map(with_names).collect();
    let curve = parameters.curve.as_ref().map(|curve| curve.map(<Symbol as shared::real::Real>::of));
    Model::new(&Parameters { pendulum, effects, formula: parameters.formula.clone(), curve })
}

/// `MASS`, or `VISCOUS_Mw`.
pub(super) fn name_of(quantity: Quantity) -> String {
    match quantity {
        Quantity::Effect { .. } | Quantity::Custom { .. } => {
            format!("{}_{}", quantity.owner().replace('-', "_").to_uppercase(), quantity.symbol())
        }
        _ => quantity.key().to_uppercase(),
    }
}

fn state_slots() -> Vec<String> {
    let n_memories = State::<f64>::N_NUMBERS - STATE.len();
    STATE.iter().map(|name| (*name).to_owned()).chain((0..n_memories).map(|idx| format!("memory_{idx}"))).collect()
}

fn sensor_slots() -> Vec<String> {
    (0..SensorState::<f64>::N_NUMBERS).map(|idx| format!("sensor_{idx}")).collect()
}

fn given_state() -> State<Symbol> {
    let slots = state_slots();
    State::from_numbers(&std::array::from_fn(|idx| Symbol::named(&slots[idx])))
}

fn given_sensor() -> SensorState<Symbol> {
    let slots = sensor_slots();
    SensorState::from_numbers(&std::array::from_fn(|idx| Symbol::named(&slots[idx])))
}

fn state_after(state: &State<Symbol>) -> Vec<(String, Symbol)> {
    state_slots().into_iter().zip(state.numbers()).collect()
}

fn sensor_after(sensor: &SensorState<Symbol>) -> Vec<(String, Symbol)> {
    sensor_slots().into_iter().zip(sensor.numbers()).collect()
}

/// Takes slots out that no function ever changes from zero; gives the others.
fn used_slots(functions: &mut [&mut Function]) -> Vec<String> {
    let is_idle = |function: &Function, slot: usize| {
        let (name, symbol) = &function.outputs[slot];
        match &function.graph.nodes[symbol.0] {
            Node::Number(bits) => f64::from_bits(*bits) == 0.0,
            Node::Name(given) => given == name,
            _ => false,
        }
    };
    let idle = |slot: usize| functions.iter().all(|function| is_idle(function, slot));
    let used: Vec<bool> = (0..functions[0].outputs.len()).map(|slot| !idle(slot)).collect();
    for function in functions.iter_mut() {
        let mut keep = used.iter();
        function.outputs.retain(|_| *keep.next().expect("a flag for each slot"));
    }
    functions[0].outputs.iter().map(|(name, _)| name.clone()).collect()
}
