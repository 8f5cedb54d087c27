//! Several simulations side by side in one number: `Model<Lanes<4>>` runs four parameter sets through the very same
//! step function that the board runs.
//!
//! A step waits for its sines, one after the other; with lanes the processor computes the others' meanwhile, two to an
//! instruction. Lanes that meet a change of regime hold up all others for that step, so put alike swings together.

use heapless::Vec;
use shared::curve::{Curve, MAX_KNOTS};
use shared::effect::MAX_VALUES;
use shared::motion::Pendulum;
use shared::parameters::{EffectValues, MAX_EFFECTS, Parameters};
use shared::real::{Mask, Real};
use std::array;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `N` numbers side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes<const N: usize>(pub [f64; N]);

/// The outcome of a comparison in each lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneMask<const N: usize>(pub [bool; N]);

/// One set of parameters a lane; `None` unless all list the same effects in the same order.
pub fn pack<const N: usize>(sets: &[&Parameters<f64>; N]) -> Option<Parameters<Lanes<N>>> {
    let of_pendulum = |pick: fn(&Pendulum<f64>) -> f64| Lanes(array::from_fn(|lane| pick(&sets[lane].pendulum)));
    let pendulum = Pendulum {
        mass_kg: of_pendulum(|p| p.mass_kg),
        length_m: of_pendulum(|p| p.length_m),
        inertia_kg_m2: of_pendulum(|p| p.inertia_kg_m2),
        gravity_m_s2: of_pendulum(|p| p.gravity_m_s2),
    };
    let first = sets.first()?;
    let same = |set: &&Parameters<f64>| {
        let kinds = |set: &Parameters<f64>| -> Vec<(u16, usize), MAX_EFFECTS> {
            set.effects.iter().map(|effect| (effect.id, effect.values.len())).collect()
        };
        kinds(set) == kinds(first)
    };
    if !sets.iter().all(|set| same(set) && set.formula == first.formula) {
        return None;
    }
    let packed = |(place, effect): (usize, &EffectValues<f64>)| {
        let value = |index: usize| Lanes(array::from_fn(|lane| sets[lane].effects[place].values[index]));
        let values: Vec<Lanes<N>, MAX_VALUES> = (0..effect.values.len()).map(value).collect();
        EffectValues { id: effect.id, values }
    };
    let effects = first.effects.iter().enumerate().map(packed).collect();
    let curve = match &first.curve {
        Some(curve) => Some(packed_curve(sets, curve.speeds_rad_s())?),
        None => None,
    };
    Some(Parameters { pendulum, effects, formula: first.formula.clone(), curve })
}

/// The curves of all lanes; `None` unless they have the same knots.
fn packed_curve<const N: usize>(sets: &[&Parameters<f64>; N], speeds_rad_s: &[f32]) -> Option<Curve<Lanes<N>>> {
    let curves: [Option<&Curve<f64>>; N] = array::from_fn(|lane| sets[lane].curve.as_ref());
    if curves.iter().any(|curve| curve.is_none_or(|curve| curve.speeds_rad_s() != speeds_rad_s)) {
        return None;
    }
    let torque = |knot: usize| Lanes(array::from_fn(|lane| curves[lane].map_or(0.0, |curve| curve.torques_nm()[knot])));
    let torques: Vec<Lanes<N>, MAX_KNOTS> = (0..speeds_rad_s.len()).map(torque).collect();
    Curve::new(speeds_rad_s, &torques)
}

impl<const N: usize> Lanes<N> {
    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let mut out = self;
        for lane in 0..N {
            out.0[lane] = f(self.0[lane]);
        }
        out
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut out = self;
        for lane in 0..N {
            out.0[lane] = f(self.0[lane], other.0[lane]);
        }
        out
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(f64, f64) -> bool) -> LaneMask<N> {
        LaneMask(array::from_fn(|lane| f(self.0[lane], other.0[lane])))
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $operator:tt) => {
        impl<const N: usize> $trait for Lanes<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $operator b)
            }
        }
    };
}

operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl<const N: usize> Mask for LaneMask<N> {
    #[inline(always)]
    fn any(self) -> bool {
        self.0.iter().fold(false, |any, lane| any | lane)
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.0.iter().fold(true, |all, lane| all & lane)
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self(array::from_fn(|lane| self.0[lane] & other.0[lane]))
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        Self(array::from_fn(|lane| self.0[lane] | other.0[lane]))
    }
    #[inline(always)]
    fn not(self) -> Self {
        Self(self.0.map(|lane| !lane))
    }
}

impl<const N: usize> Real for Lanes<N> {
    type Mask = LaneMask<N>;

    #[inline(always)]
    fn of(value: f64) -> Self {
        Self([value; N])
    }
    #[inline(always)]
    fn lt(self, other: Self) -> LaneMask<N> {
        self.compare(other, |a, b| a < b)
    }
    #[inline(always)]
    fn le(self, other: Self) -> LaneMask<N> {
        self.compare(other, |a, b| a <= b)
    }
    #[inline(always)]
    fn select(mask: LaneMask<N>, yes: Self, no: Self) -> Self {
        Self(array::from_fn(|lane| if mask.0[lane] { yes.0[lane] } else { no.0[lane] }))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.map(f64::abs)
    }
    /// The processor's own, which takes lanes at once; that of a `no_std` number takes them one by one, and where the rest
    /// is AVX it waits for each.
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }
    #[inline(always)]
    fn sin(self) -> Self {
        self.map(Real::sin)
    }
    fn exp(self) -> Self {
        self.map(Real::exp)
    }
    fn ln(self) -> Self {
        self.map(Real::ln)
    }
    fn powf(self, exponent: Self) -> Self {
        self.zip(exponent, Real::powf)
    }
    fn row<const M: usize>(self, rows: &[[Self; M]]) -> [Self; M] {
        let reaches = |row: usize, lane: usize| rows[row][0].0[lane] <= self.0[lane];
        let row_of = |lane: usize| rows.partition_point(|row| row[0].0[lane] <= self.0[lane]).saturating_sub(1);
        // Lanes differ by little, so that the row of the first is mostly that of all.
        let first = row_of(0);
        let is_it =
            |lane| (first == 0 || reaches(first, lane)) && (first + 1 == rows.len() || !reaches(first + 1, lane));
        if (1..N).all(is_it) {
            return rows[first];
        }
        let of_lane: [usize; N] = array::from_fn(row_of);
        array::from_fn(|i| Lanes(array::from_fn(|lane| rows[of_lane[lane]][i].0[lane])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::effect::Effect;
    use shared::model::Model;

    /// Four rigs that slide, creep, rest and chatter-free turn at different times; with an effect, if one is given.
    fn rigs(effect: Option<&Effect<f64>>) -> [Parameters<f64>; 4] {
        let friction =
            [(5e-4, 7e-4, 1e-3, 0.055), (4e-4, 5e-3, 1e-2, 0.02), (6e-4, 6e-4, 0.0, 0.0), (1e-3, 3e-3, 2e-3, 0.0)];
        friction.map(|(viscous, coulomb, stiction, band)| {
            let mut parameters = Parameters::paper();
            parameters.set_friction(viscous, coulomb, stiction, band);
            if let Some(effect) = effect {
                let middle = |p: &shared::effect::Parameter| 0.5 * (p.low + p.high);
                let values: std::vec::Vec<f64> = effect.parameters.iter().map(middle).collect();
                parameters.set(effect.id, &values).unwrap();
            }
            parameters
        })
    }

    fn lanes_equal_single_runs(effect: Option<&Effect<f64>>) {
        sets_equal_single_runs(&rigs(effect), effect.map_or("base", |e| e.name));
    }

    fn sets_equal_single_runs(sets: &[Parameters<f64>; 4], name: &str) {
        let starts = [1.5, -1.2, 0.4, 2.9];
        let together = Model::new(&pack(&sets.each_ref()).unwrap());
        let mut lanes = together.release(Lanes(starts), Lanes([0.0; 4]));
        let alone = sets.each_ref().map(Model::new);
        let mut states: [_; 4] = array::from_fn(|lane| alone[lane].release(starts[lane], 0.0));
        let mut lanes_sensor = together.sensor_at_rest(&lanes);
        let mut sensors: [_; 4] = array::from_fn(|lane| alone[lane].sensor_at_rest(&states[lane]));
        for step in 0..20_000 {
            together.step(&mut lanes, Lanes::of(1e-3));
            let readings = together.read(&lanes, &mut lanes_sensor);
            for lane in 0..4 {
                alone[lane].step(&mut states[lane], 1e-3);
                let reading = alone[lane].read(&states[lane], &mut sensors[lane]);
                let apart = (readings.0[lane] - reading).abs();
                assert!(apart < 1e-12, "{name} lane {lane} step {step}: {apart:e}");
            }
        }
    }

    #[test]
    fn each_lane_equals_its_run_alone() {
        lanes_equal_single_runs(None);
    }

    #[test]
    fn each_lane_equals_its_run_alone_with_every_effect() {
        for effect in Effect::<f64>::ALL.iter().filter(|effect| !effect.is_base()) {
            lanes_equal_single_runs(Some(effect));
        }
    }

    #[test]
    fn each_lane_equals_its_run_alone_with_a_friction_curve() {
        let mut sets = rigs(None);
        for (lane, set) in sets.iter_mut().enumerate() {
            let torques = [2e-3, 1e-3, 1.5e-3, 4e-3].map(|torque| torque * (1.0 + 0.3 * lane as f64));
            let curve = Curve::new(&[0.0, 0.3, 2.0, 6.0], &torques).unwrap();
            set.set_curve(&curve).unwrap();
            set.set(1, &[0.0]).unwrap();
            set.set(2, &[0.0]).unwrap();
        }
        sets_equal_single_runs(&sets, "curve");
        sets[3].set_curve(&Curve::new(&[0.0, 6.0], &[1e-3; 2]).unwrap()).unwrap();
        assert!(pack(&sets.each_ref()).is_none(), "other knots");
    }

    #[test]
    fn unlike_lists_of_effects_are_not_packed() {
        let mut other = Parameters::paper();
        other.remove(1);
        assert!(pack(&[&Parameters::paper(), &other]).is_none());
        assert!(pack::<0>(&[]).is_none());
    }
}
