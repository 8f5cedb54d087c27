//! An exported model is compiled or run, and goes the same way as ours: with every effect there is, over a whole swing.

mod export_support;

use export_support::{DT_S, EVERY, N_STEPS, RELEASE_RAD, check, dry, ours, said_by, set, with};
use host::export::{Language, export};
use host::rigfile::{Quantity, RigFile};
use shared::effect::Effect;
use std::path::Path;
use std::process::Command;

fn c(folder: &Path, file: &RigFile) -> String {
    std::fs::write(folder.join("rig.h"), export(file, Language::C).unwrap()).unwrap();
    let program = format!(
        r#"#include <stdio.h>
#include "rig.h"
int main(void) {{
    rig_state state = rig_release({RELEASE_RAD:?}, 0.0);
    rig_sensor sensor = rig_sensor_at_rest(&state);
    for (int step = 0; step < {N_STEPS}; step++) {{
        double reading = rig_read(&state, &sensor);
        if (step % {EVERY} == 0)
            printf("%.17g %.17g %.17g %.17g\n", state.angle_rad, state.velocity_rad_s, rig_friction_nm(&state), reading);
        rig_step(&state, {DT_S:?});
    }}
    return 0;
}}
"#
    );
    std::fs::write(folder.join("main.c"), program).unwrap();
    let strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-O1", "main.c", "-o", "main", "-lm"];
    said_by(Command::new("cc").args(strict).current_dir(folder));
    said_by(Command::new("./main").current_dir(folder))
}

fn python(folder: &Path, file: &RigFile) -> String {
    std::fs::write(folder.join("rig.py"), export(file, Language::Python).unwrap()).unwrap();
    let program = format!(
        r#"import rig
state = rig.release({RELEASE_RAD:?})
sensor = rig.sensor_at_rest(state)
for step in range({N_STEPS}):
    reading = rig.read(state, sensor)
    if step % {EVERY} == 0:
        print(repr(state.angle_rad), repr(state.velocity_rad_s), repr(rig.friction_nm(state)), repr(reading))
    rig.step(state, {DT_S:?})
"#
    );
    std::fs::write(folder.join("main.py"), program).unwrap();
    said_by(Command::new("python3").arg("-B").arg("main.py").current_dir(folder))
}

/// Octave runs what MATLAB runs.
fn matlab(folder: &Path, file: &RigFile) -> String {
    std::fs::write(folder.join("rig.m"), export(file, Language::Matlab).unwrap()).unwrap();
    let program = format!(
        "clear rig\ndt_s = 0;\nfor step = 0:{N_STEPS}-1\n  [angle, velocity, reading, torque] = rig([{RELEASE_RAD:?} 0], dt_s);\n  \
         dt_s = {DT_S:?};\n  if mod(step, {EVERY}) == 0\n    printf('%.17g %.17g %.17g %.17g\\n', angle, velocity, torque, \
         reading);\n  end\nend\n"
    );
    std::fs::write(folder.join("main.m"), program).unwrap();
    said_by(Command::new("octave-cli").args(["--norc", "--quiet", "main.m"]).current_dir(folder))
}

/// Every effect at once would take Octave too long; each alone over a shorter swing shows the same.
#[test]
#[ignore = "needs Octave; tests/more octave runs it"]
fn the_matlab_function_goes_the_same_way_with_every_effect() {
    let folder = tempfile::tempdir().unwrap();
    for effect in Effect::<f64>::ALL {
        let file = with(effect);
        check(effect.name, &file, &matlab(folder.path(), &file));
    }
}

/// What no Octave is needed for: one function for the block, each other one after it, no call of what is not there.
#[test]
fn the_matlab_function_has_all_that_it_calls() {
    for effect in Effect::<f64>::ALL {
        let text = export(&with(effect), Language::Matlab).unwrap();
        assert!(text.starts_with("function [angle_rad, ") && text.contains("%#codegen"), "{}", effect.name);
        let names = text.match_indices("rig_").map(|(at, _)| &text[at..]);
        for rest in names {
            let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let is_there = |line: &str| line.starts_with("function") && line.contains(&format!("{name}("));
            assert!(text.lines().any(is_there), "{}: {name} is not there", effect.name);
        }
        let count = |word: &str| text.lines().filter(|line| line.split_whitespace().next() == Some(word)).count();
        assert_eq!(count("function") + count("if") + count("for"), count("end"), "{}", effect.name);
        assert!(!text.contains('?') && !text.contains("!"), "{}: C is left in it", effect.name);
    }
}

#[test]
fn the_c_header_goes_the_same_way_with_every_effect() {
    let folder = tempfile::tempdir().unwrap();
    for effect in Effect::<f64>::ALL {
        let file = with(effect);
        check(effect.name, &file, &c(folder.path(), &file));
    }
}

#[test]
fn the_python_module_goes_the_same_way_with_every_effect() {
    let folder = tempfile::tempdir().unwrap();
    for effect in Effect::<f64>::ALL {
        let file = with(effect);
        check(effect.name, &file, &python(folder.path(), &file));
    }
}

#[test]
fn the_compared_swing_begins_fast_and_ends_at_rest() {
    let rows = ours(&dry());
    assert!(rows.iter().any(|row| row[1].abs() > 5.0) && rows.last().is_some_and(|row| row[1] == 0.0));
}

/// Of every kind: a part that acts at rest, one that opposes sliding, a power, a quotient.
#[test]
fn a_typed_formula_goes_the_same_way() {
    let folder = tempfile::tempdir().unwrap();
    let law = "\"torque = -k*omega*abs(omega)^1.5 - s*theta + 1e-6*sin(theta)/(1.5 + cos(theta)); k in 0..1e-3; s in 0..1e-2\"";
    let custom = format!("\n[effect.custom]\nformula = {law}\nk = 2e-5\ns = 3e-3\n");
    let file = RigFile::parse("rig.toml", &(dry().to_string() + &custom)).unwrap();
    check("custom", &file, &c(folder.path(), &file));
    check("custom", &file, &python(folder.path(), &file));
    assert!(export(&file, Language::Matlab).unwrap().contains("rig_pow"));
}

#[test]
fn a_friction_curve_goes_the_same_way() {
    let folder = tempfile::tempdir().unwrap();
    let mut file = dry();
    for name in ["Mw", "Mc"] {
        set(&mut file, Quantity::by_name(name).unwrap(), 0.0);
    }
    let curve = "speed = [0, 0.4, 1.5, 3, 6]\ntorque = [9e-3, 6e-3, 8e-3, 7e-3, 1.2e-2]\n";
    let file = RigFile::parse("rig.toml", &format!("{file}\n[effect.friction-curve]\n{curve}")).unwrap();
    check("curve", &file, &c(folder.path(), &file));
    check("curve", &file, &python(folder.path(), &file));
    assert!(export(&file, Language::Matlab).unwrap().contains("friction-curve"));
}

#[test]
fn several_effects_at_once_and_without_friction() {
    let folder = tempfile::tempdir().unwrap();
    let mut file = dry();
    for name in ["presliding.Fd", "quadratic-drag.Cq", "backlash.b", "sensor-lag.tau", "sensor-nonlinearity.q3"] {
        let quantity = Quantity::by_name(name).unwrap();
        set(&mut file, quantity, 5e-4);
    }
    check("several", &file, &c(folder.path(), &file));
    check("several", &file, &python(folder.path(), &file));
    let mut bare = dry();
    bare.parameters().clone().effects.iter().for_each(|effect| bare.remove_effect(effect.id));
    check("frictionless", &bare, &c(folder.path(), &bare));
}
