"""Checks an FMU as the standard (FMI 3.0.1) describes it and runs it, with nothing but Python's own library.

Usage: fmu.py FILE.fmu STEP_S N_STEPS EVERY [NAME=VALUE …]; prints angle, velocity, torque and reading every so many
steps, and complains on stderr with exit code 1.
"""

import ctypes as c
import platform
import sys
import tempfile
import xml.etree.ElementTree as xml
import zipfile
from pathlib import Path

TYPES = ["Float32", "Float64", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64", "Boolean",
         "String", "Binary", "Clock"]

# Every function of the standard, in the order of its chapters 2.2, 2.3, 3.2, 4.2 and 5.2.
FUNCTIONS = """
GetVersion SetDebugLogging InstantiateModelExchange InstantiateCoSimulation InstantiateScheduledExecution FreeInstance
EnterInitializationMode ExitInitializationMode EnterEventMode Terminate Reset GetNumberOfVariableDependencies
GetVariableDependencies GetFMUState SetFMUState FreeFMUState SerializedFMUStateSize SerializeFMUState
DeserializeFMUState GetDirectionalDerivative GetAdjointDerivative EnterConfigurationMode ExitConfigurationMode
GetIntervalDecimal GetIntervalFraction GetShiftDecimal GetShiftFraction SetIntervalDecimal SetIntervalFraction
SetShiftDecimal SetShiftFraction EvaluateDiscreteStates UpdateDiscreteStates EnterContinuousTimeMode
CompletedIntegratorStep SetTime SetContinuousStates GetContinuousStateDerivatives GetEventIndicators
GetContinuousStates GetNominalsOfContinuousStates GetNumberOfEventIndicators GetNumberOfContinuousStates EnterStepMode
GetOutputDerivatives DoStep ActivateModelPartition
""".split() + [way + kind for way in ["Get", "Set"] for kind in TYPES]

OK, ERROR = 0, 3


def demand(holds, words):
    if not holds:
        sys.exit(words)


class Unit:
    """An unpacked unit and its library."""

    def __init__(self, path, folder):
        with zipfile.ZipFile(path) as archive:
            demand(archive.testzip() is None, "the archive is damaged")
            self.names = archive.namelist()
            archive.extractall(folder)
        self.folder = Path(folder)
        self.description = xml.parse(self.folder / "modelDescription.xml").getroot()
        self.identifier = self.description.find("CoSimulation").get("modelIdentifier")
        self.variables = {one.get("name"): one for one in self.description.find("ModelVariables")}
        self.complaints = []
        heard = c.CFUNCTYPE(None, c.c_void_p, c.c_int, c.c_char_p, c.c_char_p)
        # Kept as long as the instances that call it.
        self.listener = heard(lambda _, status, category, words: self.complaints.append(words.decode()))

    def reference(self, name):
        return int(self.variables[name].get("valueReference"))

    def check_description(self):
        top = self.description
        demand(top.tag == "fmiModelDescription" and top.get("fmiVersion") == "3.0", "no FMI 3.0")
        demand(top.get("modelName") and top.get("instantiationToken"), "no name or no token")
        order = ["CoSimulation", "UnitDefinitions", "DefaultExperiment", "ModelVariables", "ModelStructure"]
        demand([child.tag for child in top] == order, "elements are missing or in another order")
        references = [one.get("valueReference") for one in self.variables.values()]
        demand(len(set(references)) == len(references) == len(list(top.find("ModelVariables"))), "references come twice")
        units = {unit.get("name") for unit in top.find("UnitDefinitions")}
        for name, one in self.variables.items():
            demand(one.tag == "Float64" and one.get("unit", "s") in units, f"{name}: its unit is not defined")
            is_parameter = one.get("causality") == "parameter"
            demand(is_parameter == (one.get("start") is not None), f"{name}: start values are those of parameters")
            demand(all(part.isidentifier() for part in name.split(".")), f"{name}: no structured name")
        independent = [one for one in self.variables.values() if one.get("causality") == "independent"]
        demand(len(independent) == 1, "there is one independent variable")
        outputs = [one.get("valueReference") for one in self.variables.values() if one.get("causality") == "output"]
        for kind in ["Output", "InitialUnknown"]:
            listed = [one.get("valueReference") for one in top.find("ModelStructure").findall(kind)]
            demand(listed == outputs, f"{kind} are {listed}, outputs {outputs}")
        build = xml.parse(self.folder / "sources/buildDescription.xml").getroot()
        demand(build.get("fmiVersion") == "3.0", "buildDescription.xml has no version")
        configuration = build.find("BuildConfiguration")
        demand(configuration.get("modelIdentifier") == self.identifier, "sources of another model")
        for source in configuration.iter("SourceFile"):
            demand((self.folder / "sources" / source.get("name")).is_file(), f"{source.get('name')} is missing")

    def load(self):
        system = {"Linux": ("linux", "so"), "Darwin": ("darwin", "dylib"), "Windows": ("windows", "dll")}
        name, ending = system[platform.system()]
        machine = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
        self.library = c.CDLL(str(self.folder / f"binaries/{machine}-{name}" / f"{self.identifier}.{ending}"))
        missing = [name for name in FUNCTIONS if not hasattr(self.library, "fmi3" + name)]
        demand(not missing, f"not exported: {missing}")
        self.library.fmi3GetVersion.restype = c.c_char_p
        demand(self.library.fmi3GetVersion() == b"3.0", "another version")

    def instantiate(self, token=None):
        create = self.library.fmi3InstantiateCoSimulation
        create.restype = c.c_void_p
        token = token or self.description.get("instantiationToken")
        flags = [c.c_bool(False)] * 4
        made = create(b"one", token.encode(), None, *flags, None, c.c_size_t(0), None, self.listener, None)
        return made and c.c_void_p(made)

    def call(self, name, instance, *arguments, expected=OK):
        status = getattr(self.library, "fmi3" + name)(instance, *arguments)
        demand(status == expected, f"{name} gives {status}: {self.complaints[-1:]}")

    def get(self, instance, names, expected=OK):
        references = (c.c_uint32 * len(names))(*[self.reference(name) for name in names])
        values = (c.c_double * len(names))()
        count = c.c_size_t(len(names))
        self.call("GetFloat64", instance, references, count, values, count, expected=expected)
        return list(values)

    def set(self, instance, name, value, expected=OK):
        references, values = (c.c_uint32 * 1)(self.reference(name)), (c.c_double * 1)(value)
        one = c.c_size_t(1)
        self.call("SetFloat64", instance, references, one, values, one, expected=expected)

    def initialize(self, instance):
        no, zero = c.c_bool(False), c.c_double(0.0)
        self.call("EnterInitializationMode", instance, no, zero, zero, no, zero)
        self.call("ExitInitializationMode", instance)

    def step(self, instance, from_s, step_s, expected=OK):
        flags = [c.c_bool() for _ in range(3)]
        reached = c.c_double()
        pointers = [c.byref(flag) for flag in flags]
        self.call("DoStep", instance, c.c_double(from_s), c.c_double(step_s), c.c_bool(False), *pointers,
                  c.byref(reached), expected=expected)
        demand(expected != OK or reached.value == from_s + step_s, f"{reached.value} s reached")


OUTPUTS = ["angle", "velocity", "torque", "reading"]


def check_behaviour(unit):
    """Starts, resets, goes back, and refuses what it must."""
    demand(unit.instantiate(token="another") is None, "a wrong token is taken")
    demand("token" in unit.complaints[-1], "and nothing said")
    instance = unit.instantiate()
    unit.step(instance, 0.0, 0.001, expected=ERROR)
    starts = {name: float(one.get("start")) for name, one in unit.variables.items() if one.get("start")}
    demand(unit.get(instance, list(starts)) == list(starts.values()), "other start values than described")
    unit.set(instance, "start_angle", -0.5)
    unit.set(instance, "longest_step", 0.0, expected=ERROR)
    unit.set(instance, "start_angle", float("nan"), expected=ERROR)
    unit.initialize(instance)
    demand(unit.get(instance, ["time", "angle"]) == [0.0, -0.5], "it begins elsewhere")
    unit.set(instance, "start_angle", 1.0, expected=ERROR)
    unit.set(instance, "angle", 1.0, expected=ERROR)

    state = c.c_void_p()
    for k in range(300):
        unit.step(instance, k / 1000, 0.001)
    unit.call("GetFMUState", instance, c.byref(state))
    size = c.c_size_t()
    unit.call("SerializedFMUStateSize", instance, state, c.byref(size))
    saved = (c.c_uint8 * size.value)()
    unit.call("SerializeFMUState", instance, state, saved, size)
    unit.step(instance, 0.3, 0.2)
    there = unit.get(instance, OUTPUTS)
    for way in range(2):
        unit.call("SetFMUState", instance, state)
        unit.step(instance, 0.3, 0.2)
        demand(unit.get(instance, OUTPUTS) == there, "it goes another way from the same state")
        unit.call("FreeFMUState", instance, c.byref(state))
        unit.call("DeserializeFMUState", instance, saved, size, c.byref(state))
    unit.call("FreeFMUState", instance, c.byref(state))

    # A heavier pendulum goes another way; both live side by side.
    other = unit.instantiate()
    mass = starts["pendulum.mass"]
    unit.set(other, "pendulum.mass", 2 * mass)
    unit.initialize(other)
    unit.call("Reset", instance)
    unit.initialize(instance)
    for one in [other, instance]:
        unit.step(one, 0.0, 0.2)
    demand(unit.get(instance, OUTPUTS) != unit.get(other, OUTPUTS), "the mass does nothing")
    demand(unit.get(instance, ["pendulum.mass"]) == [mass], "instances share their numbers")
    unit.set(other, "pendulum.mass", 0.0)
    unit.set(other, "pendulum.inertia", 0.0)
    unit.step(other, 0.2, 0.2, expected=ERROR)
    for name in ["EnterEventMode", "EnterConfigurationMode", "EnterContinuousTimeMode"]:
        unit.call(name, instance, expected=ERROR)
        demand(name in unit.complaints[-1], f"{name} is refused without a word")
    for one in [instance, other]:
        unit.call("Terminate", one)
        unit.library.fmi3FreeInstance(one)


def run(unit, step_s, n_steps, every, settings):
    instance = unit.instantiate()
    for name, value in settings.items():
        unit.set(instance, name, value)
    unit.initialize(instance)
    for k in range(n_steps):
        if k % every == 0:
            print(*[repr(value) for value in unit.get(instance, OUTPUTS)])
        unit.step(instance, k * step_s, step_s)
    unit.library.fmi3FreeInstance(instance)


def main():
    path, step_s, n_steps, every = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
    settings = {name: float(value) for name, value in (pair.split("=") for pair in sys.argv[5:])}
    with tempfile.TemporaryDirectory() as folder:
        unit = Unit(path, folder)
        unit.check_description()
        unit.load()
        check_behaviour(unit)
        run(unit, step_s, n_steps, every, settings)


main()
