-- One row a recording. Everything but `studied` follows from the file, the model and the options alone.
CREATE TABLE recording (
    rig          TEXT NOT NULL,   -- folder of the rig within the study, "." for the study's own
    recording    TEXT NOT NULL,   -- file within that folder
    file_hash    TEXT NOT NULL,   -- SHA-256 of the file
    model_hash   TEXT NOT NULL,   -- SHA-256 of the rig.toml it was fitted from
    options      TEXT NOT NULL,   -- how it was read
    program      TEXT NOT NULL,   -- version of the program
    studied      TEXT NOT NULL,   -- when, UTC
    recorded     TEXT,            -- when, as the recording says
    problem      TEXT,            -- why there is no fit; all that follows is then NULL
    samples      INTEGER,         -- of the free swing
    duration_s   REAL,            -- of the free swing
    amplitude_rad REAL,           -- largest reading of the free swing; rad/s for a sensor of rates
    period_s     REAL,            -- of small swings
    noise        REAL,            -- rms noise of the sensor, rad or rad/s
    error        REAL,            -- rms of measured minus modelled, rad or rad/s
    left_over    TEXT,            -- noise, nearly or missing
    notes        TEXT,            -- what was noticed, a line each
    PRIMARY KEY (rig, recording)
) STRICT, WITHOUT ROWID;

-- One row a fitted number of a recording, in SI units.
CREATE TABLE number (
    rig       TEXT NOT NULL,
    recording TEXT NOT NULL,
    place     INTEGER NOT NULL,   -- in the order of the fit
    symbol    TEXT NOT NULL,
    effect    TEXT NOT NULL,
    unit      TEXT NOT NULL,
    value     REAL NOT NULL,
    std       REAL,
    upper     REAL,               -- 95 % bound where that is all the swing tells
    status    TEXT NOT NULL,
    PRIMARY KEY (rig, recording, place)
) STRICT, WITHOUT ROWID;

-- One row a rig, made from the rows of its recordings.
CREATE TABLE rig (
    rig         TEXT PRIMARY KEY,
    model_hash  TEXT NOT NULL,
    program     TEXT NOT NULL,
    recordings  INTEGER NOT NULL,
    fitted      INTEGER NOT NULL,
    coulomb_nm  REAL,             -- mean of Mc over the swings that count
    coulomb_std REAL,             -- standard error of that mean
    viscous     REAL,             -- the same of Mw, N·m·s/rad
    viscous_std REAL,
    findings    TEXT NOT NULL,    -- a line each
    diagnosed   TEXT,             -- what the diagnosis was made from
    missing     TEXT,             -- effects it names, separated by commas; empty: none
    diagnosis   TEXT              -- in words
) STRICT, WITHOUT ROWID;
