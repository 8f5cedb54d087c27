//! Who may talk to the server.
//!
//! A page from anywhere in the browser can send requests to this computer. It cannot choose the headers Host and
//! Origin, so both must name this server: that stops DNS rebinding and cross-site posts. Beyond this computer a token
//! is needed too; it comes once in the address and stays in a cookie.

use super::request::Refused;
use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::header::{AUTHORIZATION, COOKIE, HOST, LOCATION, ORIGIN, SET_COOKIE};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;

/// What the cookie is called.
const COOKIE_NAME: &str = "rig-token";

/// Scripts from here only, nobody may frame the page; the plotting library writes styles into its elements.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; \
                      img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; \
                      frame-ancestors 'none'";

/// What a request must show.
#[derive(Clone, Debug)]
pub struct Access {
    address: SocketAddr,
    token: Option<Arc<str>>,
}

impl Access {
    /// For a server that listens on `address`.
    pub fn new(address: SocketAddr, token: Option<String>) -> Self {
        Self { address, token: token.map(Arc::from) }
    }

    /// Where the page is.
    pub fn url(&self) -> String {
        let query = self.token.as_ref().map_or(String::new(), |token| format!("?token={token}"));
        format!("http://{}/{query}", self.address)
    }

    /// Does a Host header name this server? A name could be anybody's, so only addresses count, and `localhost`.
    fn is_own_host(&self, host: &str) -> bool {
        let Some((name, port)) = split(host) else { return false };
        if port != self.address.port() {
            return false;
        }
        let own = self.address.ip();
        match name.parse::<IpAddr>() {
            Ok(_) if own.is_unspecified() => true,
            Ok(ip) => ip == own || (own.is_loopback() && ip.is_loopback()),
            Err(_) => name.eq_ignore_ascii_case("localhost") && (own.is_loopback() || own.is_unspecified()),
        }
    }

    /// Is the token there, if one is needed?
    fn is_known(&self, headers: &HeaderMap) -> bool {
        let Some(token) = &self.token else { return true };
        let bearer = text(headers, AUTHORIZATION).and_then(|value| value.strip_prefix("Bearer "));
        let cookies = text(headers, COOKIE).unwrap_or_default().split("; ");
        let cookie = cookies.filter_map(|pair| pair.split_once('=')).find(|(name, _)| *name == COOKIE_NAME);
        bearer.into_iter().chain(cookie.map(|(_, value)| value)).any(|given| is_same(given, token))
    }

    /// The token in the address, on the way in.
    fn arrives_with(&self, request: &Request) -> Option<Response> {
        let token = self.token.as_ref()?;
        let query = request.uri().query()?;
        let given = query.split('&').find_map(|pair| pair.strip_prefix("token="))?;
        if request.uri().path() != "/" || !is_same(given, token) {
            return None;
        }
        let cookie = format!("{COOKIE_NAME}={token}; HttpOnly; SameSite=Strict; Path=/");
        Some((StatusCode::SEE_OTHER, [(SET_COOKIE, cookie), (LOCATION, "/".to_owned())]).into_response())
    }
}

/// A token nobody can guess.
///
/// # Errors
/// The system gives no random bytes.
pub fn new_token() -> Result<String, getrandom::Error> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Lets a request pass, or says why not.
pub(super) async fn check(State(access): State<Access>, request: Request, next: Next) -> Response {
    // The path without its query, which may hold the token.
    let asked = format!("{} {}", request.method(), request.uri().path());
    let answer = match refusal(&access, &request) {
        Some(refused) => refused,
        None => next.run(request).await,
    };
    log::debug!("{asked}: {}", answer.status());
    protected(answer)
}

fn refusal(access: &Access, request: &Request) -> Option<Response> {
    let headers = request.headers();
    let host = text(headers, HOST).unwrap_or_default();
    if !access.is_own_host(host) {
        let what = format!("this server is not called {host:?}");
        return Some(
            Refused::new(StatusCode::MISDIRECTED_REQUEST, what, "open the address it printed").into_response(),
        );
    }
    let foreign_origin = headers.contains_key(ORIGIN) && text(headers, ORIGIN) != Some(&format!("http://{host}"));
    let site = headers.get("sec-fetch-site").map(HeaderValue::as_bytes);
    let changes = request.method() != "GET" && request.method() != "HEAD";
    let foreign_site = site.is_some_and(|site| site != b"same-origin" && (site != b"none" || changes));
    // Following a link to the page is no harm; everything else from another site is refused.
    let is_visit = !changes && request.uri().path() == "/";
    if foreign_origin || (foreign_site && !is_visit) {
        let what = "another web page sent this request";
        return Some(Refused::new(StatusCode::FORBIDDEN, what, "use the page of this server itself").into_response());
    }
    if access.is_known(headers) {
        return None;
    }
    let what = "the token is missing or wrong";
    let unknown =
        Refused::new(StatusCode::UNAUTHORIZED, what, "open the address that the server printed, token included");
    Some(access.arrives_with(request).unwrap_or_else(|| unknown.into_response()))
}

fn protected(mut answer: Response) -> Response<Body> {
    let headers = answer.headers_mut();
    for (name, value) in [
        ("content-security-policy", POLICY),
        ("x-content-type-options", "nosniff"),
        ("referrer-policy", "no-referrer"),
        ("cross-origin-resource-policy", "same-origin"),
        ("cache-control", "no-cache"),
    ] {
        headers.entry(name).or_insert(HeaderValue::from_static(value));
    }
    answer
}

/// Name and port of a Host header; 80 where none is given.
fn split(host: &str) -> Option<(&str, u16)> {
    let end_of_name = if host.starts_with('[') { host.find(']')? + 1 } else { host.find(':').unwrap_or(host.len()) };
    let (name, rest) = host.split_at(end_of_name);
    let port = match rest.strip_prefix(':') {
        Some(port) => port.parse().ok()?,
        None if rest.is_empty() => 80,
        None => return None,
    };
    Some((name.trim_start_matches('[').trim_end_matches(']'), port))
}

fn text(headers: &HeaderMap, name: axum::http::HeaderName) -> Option<&str> {
    headers.get(name)?.to_str().ok()
}

/// Compares every byte, so that the time taken tells nothing.
fn is_same(given: &str, token: &str) -> bool {
    let differing = given.bytes().zip(token.bytes()).fold(0, |differing, (a, b)| differing | (a ^ b));
    given.len() == token.len() && differing == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(listen: &str, host: &str, expected: bool) {
        let access = Access::new(listen.parse().unwrap(), None);
        assert_eq!(access.is_own_host(host), expected, "{host} at {listen}");
    }

    #[test]
    fn only_names_of_this_computer_are_own_hosts() {
        for host in ["127.0.0.1:7878", "localhost:7878", "[::1]:7878", "LOCALHOST:7878"] {
            check("127.0.0.1:7878", host, true);
        }
        for host in [
            "",
            "127.0.0.1",
            "127.0.0.1:80",
            "evil.example:7878",
            "127.0.0.1.evil.example:7878",
            "[::1",
            "192.168.1.5:7878",
        ] {
            check("127.0.0.1:7878", host, false);
        }
        check("192.168.1.5:7878", "192.168.1.5:7878", true);
        check("192.168.1.5:7878", "192.168.1.6:7878", false);
        check("0.0.0.0:7878", "192.168.1.5:7878", true);
        check("0.0.0.0:7878", "rig.example:7878", false);
    }

    #[test]
    fn tokens_differ_and_only_the_whole_one_counts() {
        let (one, other) = (new_token().unwrap(), new_token().unwrap());
        assert!(one.len() == 32 && one != other);
        assert!(is_same(&one, &one) && !is_same(&one[..31], &one) && !is_same("", &one));
    }
}
