//! The exported FMU: laid out as FMI 3.0 says, compiled from its own sources, and on the model's way with every effect.
#![cfg(unix)]

mod export_support;

use export_support::{DT_S, EVERY, N_STEPS, RELEASE_RAD, check, dry, said_by, with};
use host::export::fmu;
use host::rigfile::RigFile;
use shared::effect::Effect;
use std::path::Path;
use std::process::Command;
use tests::program::{self, host};
use tests::python::python;

/// Checks layout and behaviour, then runs it.
const DRIVER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/export_support/fmu.py");

/// Checked by the tool of the standard's own project, version as in tests/more.d/fmu.sh.
const FMPY: &str = "fmpy==0.3.32";

/// One of each kind: nothing added, a torque, a torque that remembers, sensors that change and that remember.
const OF_EACH_KIND: [&str; 6] =
    ["viscous", "quadratic-drag", "presliding", "sensor-nonlinearity", "backlash", "drifting-friction"];

fn save(file: &RigFile, path: &Path) {
    let unit = fmu(file).unwrap();
    assert_eq!(unit.not_compiled, None);
    std::fs::write(path, unit.archive).unwrap();
}

/// What the driver prints of a unit.
fn driven(path: &Path) -> String {
    let start = format!("start_angle={RELEASE_RAD}");
    let numbers = [DT_S.to_string(), N_STEPS.to_string(), EVERY.to_string()];
    said_by(Command::new("python3").arg("-B").arg(DRIVER).arg(path).args(numbers).arg(start))
}

#[test]
fn the_unit_is_what_the_standard_says_and_goes_the_same_way() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rig.fmu");
    for name in OF_EACH_KIND {
        let file = with(Effect::by_name(name).unwrap());
        save(&file, &path);
        check(name, &file, &driven(&path));
    }
    let law = "\"torque = -k*omega*abs(omega)^1.5 - s*theta; k in 0..1e-3; s in 0..1e-2\"";
    let custom = format!("\n[effect.custom]\nformula = {law}\nk = 2e-5\ns = 3e-3\n");
    let file = RigFile::parse("rig.toml", &(dry().to_string() + &custom)).unwrap();
    save(&file, &path);
    check("custom", &file, &driven(&path));
}

/// Without a warning, and also where no file says `RIG_…` twice; equal models make equal units.
#[test]
fn the_sources_compile_strictly_for_every_effect() {
    let folder = tempfile::tempdir().unwrap();
    for effect in Effect::<f64>::ALL {
        with(effect).save(&folder.path().join("rig.toml")).unwrap();
        let unit = strictly_made(folder.path(), &format!("{}.fmu", effect.name));
        assert!(unit == strictly_made(folder.path(), "again.fmu"), "{}", effect.name);
    }
    std::fs::remove_file(folder.path().join("again.fmu")).unwrap();
    unpack_all(folder.path());
    for effect in Effect::<f64>::ALL {
        let strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "sources/interface.c"];
        said_by(Command::new("cc").args(strict).current_dir(folder.path().join(effect.name)));
    }
}

/// A compiler to which a warning is an error. What it is asked for last holds: without optimisation it takes a third of the
/// time, and warns of the same as when it was called without. Where units are driven they are optimised.
const STRICT: &str = r#"sh -c 'exec cc -Wall -Wextra -Werror "$@" -O0' strict"#;

/// The unit of `rig.toml` with the library of that compiler.
fn strictly_made(folder: &Path, name: &str) -> Vec<u8> {
    let arguments = format!("export --format fmu rig.toml -o {name} --force");
    let output =
        Command::new(program::path()).args(arguments.split(' ')).env("CC", STRICT).current_dir(folder).output();
    let output = output.unwrap();
    let [said, told] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    assert!(output.status.success() && said.contains("binaries/"), "{name}: {said}{told}");
    std::fs::read(folder.join(name)).unwrap()
}

/// Each unit into a folder of its name.
fn unpack_all(folder: &Path) {
    let program = "import glob, zipfile\nfor name in glob.glob('*.fmu'): zipfile.ZipFile(name).extractall(name[:-4])";
    said_by(Command::new("python3").args(["-c", program]).current_dir(folder));
}

fn unpack(folder: &Path) {
    said_by(Command::new("python3").args(["-m", "zipfile", "-e", "rig.fmu", "."]).current_dir(folder));
}

#[test]
fn without_a_compiler_it_holds_its_sources_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    host(path, "init --mass 0.15 --length 0.16 --inertia 0.0027 -o rig.toml").succeeded();
    host(path, "export --format fmu rig.toml").failed(2, &["archive", "-o rig.fmu"]);
    let made = host(path, "export --format fmu rig.toml -o rig.fmu");
    assert!(made.succeeded().contains("modelDescription.xml") && made.succeeded().contains("binaries/"), "{made:?}");
    host(path, "export --format fmu rig.toml -o rig.fmu").failed(2, &["rig.fmu", "--force"]);
    let mut without = Command::new(program::path());
    without.args("export --format fmu rig.toml -o sources.fmu --json".split(' ')).env("CC", "no-such-compiler");
    let made = without.current_dir(path).output().unwrap();
    let json: serde_json::Value = serde_json::from_slice(&made.stdout).unwrap();
    let said = String::from_utf8(made.stderr).unwrap();
    assert!(made.status.success() && said.contains("no-such-compiler") && said.contains("sources only"), "{said}");
    let files: Vec<&str> = json["files"].as_array().unwrap().iter().filter_map(|file| file.as_str()).collect();
    assert!(
        files.contains(&"sources/interface.c") && !files.iter().any(|file| file.starts_with("binaries")),
        "{files:?}"
    );
}

/// The project's own tool finds nothing to complain of, and simulates it as the model goes; the standard's headers, which
/// are not ours, agree with every function.
#[test]
#[ignore = "needs fmpy from PyPI; tests/more fmu runs it"]
fn fmpy_validates_and_simulates_it() {
    let python = python(&[FMPY]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rig.fmu");
    for name in OF_EACH_KIND {
        let file = with(Effect::by_name(name).unwrap());
        save(&file, &path);
        let program = format!(
            r#"
import sys
from fmpy import simulate_fmu
from fmpy.validation import validate_fmu
problems = validate_fmu("rig.fmu")
if problems: sys.exit("\n".join(problems))
outputs = ["angle", "velocity", "torque", "reading"]
n = {N_STEPS}
rows = simulate_fmu("rig.fmu", start_values={{"start_angle": {RELEASE_RAD}}}, stop_time=n * {DT_S:?},
                    step_size={DT_S:?}, output_interval={DT_S:?}, output=outputs)
for row in rows[:n:{EVERY}]: print(*[repr(float(row[name])) for name in outputs])
"#
        );
        check(name, &file, &said_by(Command::new(&python).arg("-c").arg(program).current_dir(folder.path())));
        unpack(folder.path());
        let headers = said_by(Command::new(&python).args(["-c", "import fmpy; print(fmpy.__path__[0] + '/c-code')"]));
        std::fs::write(folder.path().join("sources/fmi.h"), "#include \"fmi3Functions.h\"\n").unwrap();
        let strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-I", headers.trim(), "-c", "sources/interface.c"];
        said_by(Command::new("cc").args(strict).current_dir(folder.path()));
    }
}
