//! What other programs read of the unit: `modelDescription.xml` and `buildDescription.xml`, FMI 3.0.1, 2.4 and 2.5.3.

use crate::export::Number;
use std::fmt::Write;

/// Value reference of the first of the model's numbers; `interface.c` has the same.
const FIRST_NUMBER: usize = 100;

/// Value references of the outputs.
const OUTPUTS: std::ops::RangeInclusive<u32> = 4..=7;

const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

/// What is known before the run and what comes out of it; names and value references as in `interface.c`.
const VARIABLES: &str = r#"
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous" unit="s"/>
    <Float64 name="start_angle" valueReference="1" causality="parameter" variability="fixed" start="1.5" unit="rad"
             description="where it is let go, 0 hanging, counter-clockwise positive"/>
    <Float64 name="start_velocity" valueReference="2" causality="parameter" variability="fixed" start="0" unit="rad/s"
             description="how fast it turns then"/>
    <Float64 name="longest_step" valueReference="3" causality="parameter" variability="fixed" start="0.001" unit="s"
             description="longer communication steps are taken in equal pieces; the sensor is read after each"/>
    <Float64 name="angle" valueReference="4" causality="output" variability="continuous" initial="calculated" unit="rad"
             description="the pendulum's angle"/>
    <Float64 name="velocity" valueReference="5" causality="output" variability="continuous" initial="calculated"
             unit="rad/s" description="its angular velocity"/>
    <Float64 name="reading" valueReference="6" causality="output" variability="continuous" initial="calculated"
             unit="rad" description="what the sensor shows"/>
    <Float64 name="torque" valueReference="7" causality="output" variability="continuous" initial="calculated"
             unit="N·m" description="friction and all added effects; at rest what the bearing holds"/>
"#;

/// Units of which other programs may know more than the name.
const KNOWN: [(&str, &str); 10] = [
    ("s", "s=\"1\""),
    ("m", "m=\"1\""),
    ("kg", "kg=\"1\""),
    ("rad", "rad=\"1\""),
    ("rad/s", "rad=\"1\" s=\"-1\""),
    ("m/s²", "m=\"1\" s=\"-2\""),
    ("kg·m²", "kg=\"1\" m=\"2\""),
    ("N·m", "kg=\"1\" m=\"2\" s=\"-2\""),
    ("N·m/rad", "kg=\"1\" m=\"2\" s=\"-2\" rad=\"-1\""),
    ("N·m·s/rad", "kg=\"1\" m=\"2\" s=\"-1\" rad=\"-1\""),
];

/// `modelDescription.xml`.
pub(super) fn model(identifier: &str, token: &str, numbers: &[Number]) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let (units, variables) = (units(numbers), VARIABLES[1..].to_owned() + &variables(numbers));
    let structure: String = ["Output", "InitialUnknown"].map(unknowns).concat();
    format!(
        r#"{HEAD}<fmiModelDescription fmiVersion="3.0" modelName="{identifier}" instantiationToken="{token}"
    description="A pendulum with the friction and the sensor that were identified" generationTool="host {version}"
    variableNamingConvention="structured">
  <CoSimulation modelIdentifier="{identifier}" canHandleVariableCommunicationStepSize="true"
      canGetAndSetFMUState="true" canSerializeFMUState="true"/>
  <UnitDefinitions>
{units}  </UnitDefinitions>
  <DefaultExperiment startTime="0" stopTime="10" stepSize="0.001"/>
  <ModelVariables>
{variables}  </ModelVariables>
  <ModelStructure>
{structure}  </ModelStructure>
</fmiModelDescription>
"#
    )
}

fn unknowns(kind: &str) -> String {
    OUTPUTS.map(|reference| format!("    <{kind} valueReference=\"{reference}\"/>\n")).collect()
}

/// `buildDescription.xml`: how another computer makes the library.
pub(super) fn build(identifier: &str) -> String {
    format!(
        r#"{HEAD}<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="{identifier}" description="interface.c includes the other files">
    <SourceFileSet language="C99">
      <SourceFile name="interface.c"/>
    </SourceFileSet>
  </BuildConfiguration>
</fmiBuildDescription>
"#
    )
}

fn units(numbers: &[Number]) -> String {
    let known = |unit: &str| KNOWN.iter().any(|(name, _)| *name == unit);
    let mut others: Vec<&str> =
        numbers.iter().map(|n| n.unit).filter(|unit| !unit.is_empty() && !known(unit)).collect();
    others.sort_unstable();
    others.dedup();
    let mut text = String::new();
    for (name, base) in KNOWN {
        let _ = writeln!(text, "    <Unit name=\"{name}\"><BaseUnit {base}/></Unit>");
    }
    for name in others {
        let _ = writeln!(text, "    <Unit name=\"{}\"/>", escaped(name));
    }
    text
}

/// The model's numbers, which may be changed while it runs.
fn variables(numbers: &[Number]) -> String {
    let mut text = String::new();
    for (idx, number) in numbers.iter().enumerate() {
        let (name, reference) = (escaped(&number.path.replace('-', "_")), FIRST_NUMBER + idx);
        let unit = if number.unit.is_empty() { String::new() } else { format!(" unit=\"{}\"", escaped(number.unit)) };
        let (value, meaning) = (number.value, escaped(number.meaning));
        let _ = writeln!(
            text,
            "    <Float64 name=\"{name}\" valueReference=\"{reference}\" causality=\"parameter\" \
             variability=\"tunable\" start=\"{value:?}\"{unit}\n             description=\"{meaning}\"/>"
        );
    }
    text
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
