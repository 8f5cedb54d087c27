//! The program serving its page, and plain HTTP to talk to it as a browser, or an attacker, would.

use crate::HANG;
use crate::program::{self, PATIENT};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// `host serve`, ended when dropped.
pub struct Server {
    child: Child,
    /// `127.0.0.1:PORT`
    pub address: String,
    /// What was printed: the page's address, token included.
    pub url: String,
}

/// An answer.
#[derive(Debug)]
pub struct Answer {
    /// HTTP status.
    pub status: u16,
    /// Header lines, as they came.
    pub head: String,
    /// The body.
    pub body: Vec<u8>,
}

impl Answer {
    /// The body as JSON.
    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }

    /// A refusal says what is wrong and what to do next.
    #[track_caller]
    pub fn refused(&self, status: u16, words: &str) {
        assert_eq!(self.status, status, "{self:?}");
        let body = self.json();
        assert!(body["what"].as_str().is_some_and(|what| what.contains(words)), "{words:?} is not in {body}");
        assert!(body["next"].as_str().is_some_and(|next| !next.is_empty()), "{body}");
    }
}

impl Server {
    /// Starts in a folder with arguments separated by spaces, on a free port of this computer.
    pub fn start(folder: &Path, arguments: &str) -> Self {
        Self::start_at(folder, "127.0.0.1:0", arguments)
    }

    /// The same, listening elsewhere.
    pub fn start_at(folder: &Path, listen: &str, arguments: &str) -> Self {
        let mut child = Command::new(program::path())
            .args(["serve", "--no-open", "--listen", listen])
            .args(arguments.split_whitespace())
            .current_dir(folder)
            .env(PATIENT.0, PATIENT.1)
            .env("XDG_STATE_HOME", program::state_of(folder))
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts");
        let mut url = String::new();
        let stdout = child.stdout.take().expect("piped");
        BufReader::new(stdout).read_line(&mut url).expect("the address is printed");
        let url = url.trim().to_owned();
        let address = url.trim_start_matches("http://").split('/').next().unwrap_or_default().to_owned();
        assert!(!address.is_empty(), "no address was printed");
        Self { child, address, url }
    }

    /// One request on a connection of its own.
    pub fn ask(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Answer {
        let mut stream = self.connect();
        let host = if headers.iter().any(|(name, _)| name.eq_ignore_ascii_case("host")) {
            String::new()
        } else {
            format!("Host: {}\r\n", self.local())
        };
        let lines: String = headers.iter().map(|(name, value)| format!("{name}: {value}\r\n")).collect();
        let length = body.len();
        let head =
            format!("{method} {path} HTTP/1.1\r\n{host}{lines}Content-Length: {length}\r\nConnection: close\r\n\r\n");
        stream.write_all(head.as_bytes()).expect("sent");
        // A server that refuses early closes before everything is sent.
        let _ = stream.write_all(body);
        let mut bytes = Vec::new();
        let _ = stream.read_to_end(&mut bytes);
        parsed(&bytes)
    }

    /// A GET.
    pub fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, &[], &[])
    }

    /// A POST of JSON, as the page does it.
    pub fn post(&self, path: &str, json: &str) -> Answer {
        let origin = format!("http://{}", self.local());
        self.ask("POST", path, &[("Content-Type", "application/json"), ("Origin", &origin)], json.as_bytes())
    }

    /// Uploads a recording.
    pub fn upload(&self, name: &str, bytes: &[u8]) -> Answer {
        self.ask("POST", &format!("/api/recordings?name={name}"), &[], bytes)
    }

    /// The address to connect to; all addresses are reached through this computer's own.
    pub fn local(&self) -> String {
        self.address.replace("0.0.0.0", "127.0.0.1")
    }

    /// A connection.
    pub fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.local()).expect("the server listens");
        stream.set_read_timeout(Some(HANG)).expect("a time");
        stream
    }

    /// A tab's socket, already open.
    pub fn tab(&self) -> Tab {
        let mut stream = self.connect();
        stream.write_all(upgrade(&self.local(), &format!("http://{}", self.local())).as_bytes()).expect("sent");
        let mut head = Vec::new();
        let mut byte = [0];
        while !head.ends_with(b"\r\n\r\n") {
            stream.read_exact(&mut byte).expect("an answer");
            head.push(byte[0]);
        }
        assert!(head.starts_with(b"HTTP/1.1 101"), "{}", String::from_utf8_lossy(&head));
        Tab(stream)
    }

    /// Process id.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Ctrl-C; gives the exit code once it has ended.
    pub fn interrupt(mut self) -> Option<i32> {
        let began = Instant::now();
        let told = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status();
        assert!(told.is_ok_and(|status| status.success()));
        while began.elapsed() < HANG {
            if let Some(status) = self.child.try_wait().expect("a child") {
                return status.code();
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        panic!("it did not end within {HANG:?}");
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The request that opens a tab's socket.
pub fn upgrade(host: &str, origin: &str) -> String {
    format!(
        "GET /events HTTP/1.1\r\nHost: {host}\r\nOrigin: {origin}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAECAwQFBgcICQoLDA0ODw==\r\n\r\n"
    )
}

/// One tab's WebSocket (RFC 6455), as far as a server's text frames need it.
pub struct Tab(TcpStream);

impl Tab {
    /// The next message.
    pub fn hear(&mut self) -> Value {
        loop {
            let [first, second] = self.take();
            let length = match second & 0x7f {
                126 => usize::from(u16::from_be_bytes(self.take())),
                127 => u64::from_be_bytes(self.take()) as usize,
                short => usize::from(short),
            };
            let mut text = vec![0; length];
            self.0.read_exact(&mut text).expect("a whole frame");
            if first & 0x0f == 1 {
                return serde_json::from_slice(&text).expect("JSON");
            }
        }
    }

    /// Waits for a state that is as wanted.
    #[track_caller]
    pub fn wait_for(&mut self, wanted: impl Fn(&Value) -> bool) -> Value {
        let began = Instant::now();
        let mut last = Value::Null;
        while began.elapsed() < HANG {
            let message = self.hear();
            if message["type"] == "state" {
                if wanted(&message) {
                    return message;
                }
                last = message;
            }
        }
        panic!("waited in vain; the last state was {last}");
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        self.0.read_exact(&mut bytes).expect("the socket stays open");
        bytes
    }
}

fn parsed(bytes: &[u8]) -> Answer {
    let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").unwrap_or(bytes.len());
    let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
    let status = head.split(' ').nth(1).and_then(|code| code.parse().ok()).unwrap_or(0);
    let body = bytes.get(end + 4..).unwrap_or_default().to_vec();
    let body = if head.to_ascii_lowercase().contains("transfer-encoding: chunked") { joined(&body) } else { body };
    Answer { status, head, body }
}

/// Chunks put together.
fn joined(mut chunks: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    while let Some(end) = chunks.windows(2).position(|two| two == b"\r\n") {
        let length = std::str::from_utf8(&chunks[..end]).ok().and_then(|hex| usize::from_str_radix(hex, 16).ok());
        let Some(length) = length.filter(|length| *length > 0 && end + 2 + length <= chunks.len()) else { break };
        body.extend(&chunks[end + 2..end + 2 + length]);
        chunks = chunks.get(end + 4 + length..).unwrap_or_default();
    }
    body
}
