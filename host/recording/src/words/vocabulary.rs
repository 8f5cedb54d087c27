//! The words themselves, in all languages.

/// Words after which a column is not the angle itself, whatever else it says.
pub(super) const DERIVED: &[&str] = &[
    "omega",
    "ω",
    "velocity",
    "vel",
    "velo",
    "speed",
    "acceleration",
    "acc",
    "accel",
    "accl",
    "alpha",
    "α",
    "rate",
    "dot",
    "target",
    "setpoint",
    "reference",
    "ref",
    "v",
    "gyro",
    "gyr",
    "gyroscope",
    "gyroskop",
    "tacho",
    "tachometer",
    "rpm",
    "derivative",
    "error",
    "residual",
    "model",
    "fit",
    "std",
    "sigma",
    "noise",
    "punkt",
    "geschwindigkeit",
    "winkelgeschwindigkeit",
    "drehrate",
    "beschleunigung",
    "winkelbeschleunigung",
    "drehzahl",
    "sollwert",
    "ableitung",
    "vitesse",
    "accélération",
    "consigne",
    "gyromètre",
    "gyroscope",
    "velocidad",
    "aceleración",
    "aceleracion",
    "giroscopio",
    "consigna",
    "derivada",
    "fft",
    "psd",
    "spectrum",
    "spektrum",
    "spectre",
    "espectro",
    "spettro",
    "velocità",
    "velocita",
    "accelerazione",
    "角速度",
    "角加速度",
];

/// Words of an angular velocity among them, if the unit does not say it.
pub(super) const RATE: &[&str] = &[
    "omega",
    "ω",
    "gyro",
    "gyr",
    "gyroscope",
    "gyroskop",
    "gyromètre",
    "giroscopio",
    "tacho",
    "tachometer",
    "rate",
    "drehrate",
    "winkelgeschwindigkeit",
    "rpm",
    "drehzahl",
    "角速度",
];

pub(super) const TIME: &[&str] = &[
    "t",
    "time",
    "times",
    "timestamp",
    "datetime",
    "elapsed",
    "clock",
    "epoch",
    "zeit",
    "zeitpunkt",
    "zeitstempel",
    "uhrzeit",
    "messzeit",
    "temps",
    "heure",
    "horodatage",
    "tiempo",
    "hora",
    "tempo",
    "ora",
    "ts",
    "tout",
    "tijd",
    "tid",
    "aika",
    "czas",
    "čas",
    "idő",
    "zaman",
    "время",
    "час",
    "时间",
    "時間",
    "时刻",
    "時刻",
    "시간",
];

/// Words of a day, and of the time since the row before, which are the time where nothing else is.
pub(super) const DATE: &[&str] = &["date", "datum", "fecha", "dt", "δt"];

pub(super) const ANGLE: &[&str] = &[
    "theta",
    "th",
    "tita",
    "teta",
    "angle",
    "angles",
    "ang",
    "position",
    "pos",
    "phi",
    "θ",
    "θr",
    "thetar",
    "φ",
    "ϑ",
    "winkel",
    "auslenkwinkel",
    "pendelwinkel",
    "drehwinkel",
    "ángulo",
    "ángulos",
    "angulo",
    "angulos",
    "angolo",
    "angoli",
    "ângulo",
    "ângulos",
    "hoek",
    "vinkel",
    "kulma",
    "kąt",
    "kat",
    "úhel",
    "uhel",
    "szög",
    "açı",
    "угол",
    "кут",
    "角度",
    "摆角",
    "擺角",
    "角位移",
    "각도",
];
/// Words that name the angle behind a word such as angular.
pub(super) const DISPLACEMENT: &[&str] = &[
    "displacement",
    "position",
    "elongation",
    "déplacement",
    "elongación",
    "desplazamiento",
    "posición",
    "posicion",
    "deslocamento",
    "posição",
    "spostamento",
    "posizione",
];

pub(super) const TILT: &[&str] =
    &["tilt", "inclination", "neigung", "neigungswinkel", "inclinaison", "inclinación", "inclinazione"];

pub(super) const CODE: &[&str] = &["code", "codes", "adc"];

/// Words of a point in a picture.
pub(super) const X: &[&str] = &["x", "cx", "xc", "xpos", "posx", "xcoord"];
pub(super) const Y: &[&str] = &["y", "cy", "yc", "ypos", "posy", "ycoord"];

/// Of a sensor or a program that gives no angle, but these.
pub(super) const SINE: &[&str] = &["sin", "sine", "sinus", "sen", "seno"];
pub(super) const COSINE: &[&str] = &["cos", "cosine", "cosinus", "kosinus", "coseno"];

/// Units that no angle and no time has.
pub(super) const OTHER_UNITS: &[&str] = &[
    "m", "cm", "mm", "px", "pixel", "pixels", "in", "inch", "volt", "volts", "mv", "hz", "percent", "counts", "count",
    "ticks", "raw",
];

/// Words and units of what is neither a time nor of the pendulum, though its name may hold a `t` or an `x`.
pub(super) const OTHER_QUANTITIES: &[&str] = &[
    "ut",
    "µt",
    "μt",
    "nt",
    "mt",
    "gauss",
    "tesla",
    "field",
    "feld",
    "magnetic",
    "magnetfeld",
    "mag",
    "magnetometer",
    "force",
    "kraft",
    "temperature",
    "temperatur",
    "celsius",
    "°c",
    "pressure",
    "hpa",
];

/// Words of where something is on earth and where it goes.
pub(super) const OF_PLACE: &[&str] =
    &["latitude", "longitude", "direction", "heading", "course", "azimuth", "breitengrad", "längengrad", "richtung"];

/// Words of a speed.
pub(super) const SPEED: &[&str] =
    &["dot", "punkt", "velocity", "vel", "velo", "speed", "v", "geschwindigkeit", "vitesse", "velocidad", "velocità"];
