//! A real browser, headless, driven through chromedriver.

use crate::HANG;
use fantoccini::error::CmdError;
use fantoccini::{Client, ClientBuilder, Locator};
use hyper_util::client::legacy::connect::HttpConnector;
use serde_json::{Value, json};
use std::io::{self, BufRead, BufReader, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A window is not made narrower; a phone has to be emulated, pixels.
const NARROWEST_WINDOW: u32 = 500;

/// Between two looks.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// An open browser and its driver; both end when dropped.
pub struct Browser {
    /// For whatever has no name here.
    pub client: Client,
    driver: Child,
    port: u16,
}

impl Browser {
    /// Opens a page in a window of this size, pixels.
    pub async fn open(url: &str, width: u32, height: u32) -> Self {
        let (driver, port) = driver();
        let arguments = [
            "--headless=new".to_owned(),
            "--no-sandbox".to_owned(),
            "--disable-dev-shm-usage".to_owned(),
            "--enable-unsafe-swiftshader".to_owned(),
            format!("--window-size={width},{height}"),
        ];
        let mut capabilities = serde_json::Map::new();
        let mut options = json!({ "args": arguments });
        if width < NARROWEST_WINDOW {
            let metrics =
                json!({ "width": width, "height": height, "pixelRatio": 1.0, "mobile": true, "touch": false });
            options["mobileEmulation"] = json!({ "deviceMetrics": metrics });
        }
        capabilities.insert("goog:chromeOptions".to_owned(), options);
        // By itself it gives a script half a minute, which a page that draws on a busy machine may take before it listens.
        let hang_ms = HANG.as_millis() as u64;
        capabilities.insert("timeouts".to_owned(), json!({ "script": hang_ms, "pageLoad": hang_ms }));
        let mut builder = ClientBuilder::new(HttpConnector::new());
        builder.capabilities(capabilities);
        let client = builder.connect(&format!("http://127.0.0.1:{port}")).await.expect("chromium starts");
        client.goto(url).await.expect("the page opens");
        Self { client, driver, port }
    }

    /// Runs a script in the page and gives what it returns.
    pub async fn run(&self, script: &str) -> Value {
        self.client.execute(script, vec![]).await.unwrap_or_else(|error| panic!("{script}: {error}"))
    }

    /// Waits until an expression of the page is true.
    pub async fn wait_for(&self, expression: &str) {
        let began = Instant::now();
        while began.elapsed() < HANG {
            if self.run(&format!("return !!({expression})")).await == true {
                return;
            }
            tokio::time::sleep(LOOK_EVERY).await;
        }
        let seen = self.run("return document.body.innerText").await;
        panic!("waited in vain for {expression}; the page says {seen}");
    }

    /// The text of an element as a person sees it; it may be redrawn at any time, so the page itself is asked.
    pub async fn text(&self, selector: &str) -> String {
        let text = self.run(&format!("return document.querySelector({selector:?})?.innerText ?? ''")).await;
        text.as_str().unwrap_or_default().to_owned()
    }

    /// Clicks an element once it is there and enabled.
    pub async fn click(&self, selector: &str) {
        let found = format!("document.querySelector({selector:?})");
        self.wait_for(&format!("{found} && !{found}.disabled && {found}.checkVisibility()")).await;
        self.run(&format!("{found}.scrollIntoView({{ block: 'center' }})")).await;
        let element =
            self.client.find(Locator::Css(selector)).await.unwrap_or_else(|error| panic!("{selector}: {error}"));
        element.click().await.unwrap_or_else(|error| panic!("{selector}: {error}"));
    }

    /// Chooses a file of this computer for upload.
    pub async fn upload(&self, selector: &str, path: &Path) {
        let element = self.client.find(Locator::Css(selector)).await.expect(selector);
        element.send_keys(&path.display().to_string()).await.expect("chosen");
    }

    /// The number that an element begins with.
    pub async fn number(&self, selector: &str) -> Option<f64> {
        let text = self.text(selector).await;
        text.split_whitespace().next().and_then(|first| first.parse().ok())
    }

    /// Keeps a picture of the page for people to look at.
    pub async fn keep_picture(&self, name: &str) {
        let png = patiently(async || self.client.screenshot().await).await;
        std::fs::write(pictures().join(format!("{name}.png")), png).expect("written");
    }

    /// A picture of an element.
    pub async fn picture_of(&self, selector: &str) -> Vec<u8> {
        let element = self.client.find(Locator::Css(selector)).await.expect(selector);
        patiently(async || element.screenshot().await).await
    }

    /// Sets the window's size, pixels.
    pub async fn resize(&self, width: u32, height: u32) {
        self.client.set_window_size(width, height).await.expect("a size");
    }

    /// Closes the browser.
    pub async fn close(self) {
        let _ = self.client.clone().close().await;
    }
}

/// The driver gives a picture up after ten seconds, which a busy machine may take.
async fn patiently(picture: impl AsyncFn() -> Result<Vec<u8>, CmdError>) -> Vec<u8> {
    let began = Instant::now();
    loop {
        match picture().await {
            Err(error) if error.to_string().contains("timeout") && began.elapsed() < HANG => {}
            taken => return taken.expect("a picture"),
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Killed at once, the driver would leave the browser of a failed test running.
        let _ = shut_down(self.port);
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}

/// Ends the browsers of a driver.
fn shut_down(port: u16) -> io::Result<()> {
    let mut stream = TcpStream::connect(("127.0.0.1", port))?;
    stream.set_read_timeout(Some(HANG))?;
    stream.write_all(b"GET /shutdown HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")?;
    io::copy(&mut stream, &mut io::sink())?;
    Ok(())
}

/// Where pictures are kept: `target/page-pictures`.
pub fn pictures() -> PathBuf {
    let test = std::env::current_exe().expect("a test knows its own path");
    let target = test.ancestors().nth(3).expect("tests lie in target/PROFILE/deps");
    let folder = target.join("page-pictures");
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Starts chromedriver on a free port. Somebody else may take the port before it listens: then it ends, and another is
/// started.
fn driver() -> (Child, u16) {
    (0..MOST_DRIVERS).find_map(|_| listening_driver()).expect("chromedriver tells its port")
}

/// So many in turn find no port only where something else is wrong.
const MOST_DRIVERS: usize = 5;

fn listening_driver() -> Option<(Child, u16)> {
    let mut child = Command::new("chromedriver")
        .arg("--port=0")
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("chromedriver; tests/run installs chromium and chromium-driver");
    let mut lines = BufReader::new(child.stdout.take().expect("piped")).lines();
    let port = lines.by_ref().map_while(Result::ok).find_map(|line| {
        let (_, port) = line.split_once("started successfully on port ")?;
        port.trim_end_matches('.').parse().ok()
    });
    let Some(port) = port else {
        child.wait().expect("a driver without a port ends");
        return None;
    };
    // What it says later would fill the pipe.
    std::thread::spawn(move || lines.for_each(drop));
    Some((child, port))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Processes whose parent is this one.
    fn children(parent: u32) -> Vec<PathBuf> {
        let all = std::fs::read_dir("/proc").unwrap().filter_map(Result::ok).map(|entry| entry.path());
        let is_child = |process: &PathBuf| {
            let status = std::fs::read_to_string(process.join("status")).unwrap_or_default();
            status.lines().any(|line| line == format!("PPid:\t{parent}"))
        };
        all.filter(is_child).collect()
    }

    #[test]
    fn the_browser_of_a_failed_test_ends_with_it() {
        tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(async {
            let browser = Browser::open("about:blank", 800, 600).await;
            let browsers = children(browser.driver.id());
            assert!(!browsers.is_empty());
            drop(browser);
            assert!(browsers.iter().all(|process| !process.exists()), "{browsers:?}");
        });
    }
}
