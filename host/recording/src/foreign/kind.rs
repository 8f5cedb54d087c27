//! What a file is, by its first bytes.

use super::{lists, mat4, mat5, numpy};

/// What a file is, by its first bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// phyphox exports an archive of CSV files; workbooks are archives too, and several arrays of NumPy.
    Zip,
    /// An array of NumPy.
    Numpy,
    /// MATLAB, versions 4 to 7.
    Matlab,
    /// HDF5, which MATLAB 7.3 writes.
    Hdf5,
    /// OLE2, in which older spreadsheets keep their workbooks.
    OldWorkbook,
    /// Project of CASSY Lab 1, text.
    Cassy1,
    /// LabVIEW measurement file, text.
    LabView,
    /// JSON: an object a line, or one array or object.
    Json,
    /// Lists as programs print them.
    Lists,
    /// XML or HTML: projects of Tracker and others.
    Markup,
    /// What is known, and not read: its place in [`UNREAD`].
    Unread(usize),
}

/// What begins a file that is not read, what it is, and what to do.
pub(super) const UNREAD: [(&[u8], &str, &str); 18] = [
    (b"\x80\x02", PICKLE, PICKLE_CURE),
    (b"\x80\x03", PICKLE, PICKLE_CURE),
    (b"\x80\x04", PICKLE, PICKLE_CURE),
    (b"\x80\x05", PICKLE, PICKLE_CURE),
    (b"PAR1", "Parquet file", FRAME_CURE),
    (b"ARROW1", "Feather file", FRAME_CURE),
    (b"FEA1", "Feather file", FRAME_CURE),
    (b"#ROSBAG V", "bag of ROS", "print the topic as a table: rostopic echo -p -b swing.bag /joint_states > swing.csv"),
    (b"\x89MCAP", "bag of ROS 2", BAG_CURE),
    (b"SQLite format 3", "database, as bags of ROS 2 are", BAG_CURE),
    (b"TDSm", "TDMS file", "in LabVIEW write a measurement file as text (.lvm), or export it as CSV"),
    (b"\x1f\x8b", "packed file (gzip)", UNPACK),
    (b"BZh", "packed file (bzip2)", UNPACK),
    (b"\xfd7zXZ", "packed file (xz)", UNPACK),
    (b"7z\xbc\xaf", "packed file (7z)", UNPACK),
    (b"Rar!", "packed file (rar)", UNPACK),
    (b"\x1aE\xdf\xa3", "video", VIDEO_CURE),
    (b"RIFF", "video or sound", VIDEO_CURE),
];

const PICKLE: &str = "Python pickle";
const PICKLE_CURE: &str = "a pickle may run any program, so that none is read; save it as text: \
                           numpy.savetxt(\"swing.csv\", numpy.c_[t, theta]), or table.to_csv(\"swing.csv\")";
const FRAME_CURE: &str = "save it as text: pandas.read_parquet or read_feather, and then table.to_csv(\"swing.csv\")";
const BAG_CURE: &str = "play it and print the topic as a table: ros2 topic echo --csv /joint_states > swing.csv";
const UNPACK: &str = "unpack it first";
const VIDEO_CURE: &str =
    "follow a point of the pendulum in it with a program such as Tracker, and export time, x and y as text";

impl Kind {
    /// `None` for a table of text, or for what nobody knows.
    pub(crate) fn of(head: &[u8]) -> Option<Self> {
        let begins = |text: &str| head.starts_with(text.as_bytes());
        let first = head.iter().find(|byte| !byte.is_ascii_whitespace());
        let is_list = head.iter().filter(|byte| !byte.is_ascii_whitespace()).take(2).eq(b"[[");
        let is_json =
            first == Some(&b'{') || is_list || (first == Some(&b'[') && head.iter().any(|byte| b"{\"".contains(byte)));
        match () {
            () if begins("PK\x03\x04") => Some(Self::Zip),
            () if numpy::begins(head) => Some(Self::Numpy),
            () if head.starts_with(b"\xd0\xcf\x11\xe0") => Some(Self::OldWorkbook),
            () if begins("MATLAB 7.3") || head.starts_with(b"\x89HDF") => Some(Self::Hdf5),
            () if begins("MATLAB 5.0") || mat5::begins(head) || mat4::begins(head) => Some(Self::Matlab),
            () if begins("CL4\r\n") || begins("CL4\n") => Some(Self::Cassy1),
            () if begins("LabVIEW Measurement") => Some(Self::LabView),
            () if lists::begins(head) => Some(Self::Lists),
            () if is_json => Some(Self::Json),
            () if is_markup(head) => Some(Self::Markup),
            () if head.get(4..8) == Some(b"ftyp") => {
                UNREAD.iter().position(|unread| unread.1 == "video").map(Self::Unread)
            }
            () => UNREAD.iter().position(|(begin, ..)| head.starts_with(begin)).map(Self::Unread),
        }
    }
}

/// Does it begin with a tag?
fn is_markup(head: &[u8]) -> bool {
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    text.first() == Some(&b'<') && text.get(1).is_some_and(|next| next.is_ascii_alphabetic() || b"?!".contains(next))
}
