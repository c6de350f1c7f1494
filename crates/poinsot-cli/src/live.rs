//! A page with live curves: the lines of `follow`, sent to browsers as events.
//!
//! The lines are kept in one list. Each browser has a thread that waits for the next ones and writes them, so a slow browser waits
//! for itself alone; one that comes again says which line it had last.

use poinsot::Error;
use poinsot_files::Place;
use std::collections::VecDeque;
use std::io::{Result, Write};
use std::net::SocketAddr;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tiny_http::{Header, Request, Response, Server};

/// Lines that are kept.
const LINES: usize = 20_000;
/// Browsers at a time.
const BROWSERS: usize = 32;
/// Time without a line after which a browser is asked whether it is still there.
const QUIET: Duration = Duration::from_secs(10);
/// Time that browsers have for the end.
const FAREWELL: Duration = Duration::from_secs(1);
const HEAD: &[u8] =
    b"HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\n\
X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n";

/// The lines so far.
#[derive(Default)]
struct Lines {
    /// Number of the first one that is kept.
    first: usize,
    kept: VecDeque<String>,
    ended: bool,
}

/// A page that is being served.
#[derive(Default)]
pub struct Feed {
    lines: Mutex<Lines>,
    changed: Condvar,
    /// Every browser that reads the lines holds a clone.
    browsers: Arc<()>,
}

impl Feed {
    fn lines(&self) -> MutexGuard<'_, Lines> {
        self.lines.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a line.
    pub fn push(&self, line: String) {
        let mut lines = self.lines();
        lines.kept.push_back(line);
        if lines.kept.len() > LINES {
            lines.kept.pop_front();
            lines.first += 1;
        }
        self.changed.notify_all();
    }

    /// No further line comes; waits a moment until the browsers know.
    pub fn end(&self) {
        self.lines().ended = true;
        self.changed.notify_all();
        let begun = Instant::now();
        while Arc::strong_count(&self.browsers) > 1 && begun.elapsed() < FAREWELL {
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Lines from a number on as events, the number of the next one, and whether there is none.
    fn events(&self, from: usize) -> (String, usize, bool) {
        let wait = |l: &mut Lines| l.first + l.kept.len() <= from && !l.ended;
        let waited = self.changed.wait_timeout_while(self.lines(), QUIET, wait);
        let (lines, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let from = from.max(lines.first);
        let new = lines.kept.iter().skip(from - lines.first).enumerate();
        let event = |(k, line): (usize, &String)| format!("id: {}\ndata: {line}\n\n", from + k);
        (
            new.map(event).collect(),
            lines.first + lines.kept.len(),
            lines.ended,
        )
    }

    fn stream(&self, mut out: impl Write, mut next: usize) -> Result<()> {
        out.write_all(HEAD)?;
        loop {
            let (events, after, ended) = self.events(next);
            // A comment, where there is nothing new.
            let text = if events.is_empty() { ":\n\n" } else { &events };
            out.write_all(text.as_bytes())?;
            if ended {
                out.write_all(b"event: end\ndata:\n\n")?;
            }
            out.flush()?;
            if ended {
                return Ok(());
            }
            next = after;
        }
    }
}

/// Serves a page, and the lines of a feed as `events` beside it; gives the address of the page.
///
/// # Errors
/// The address cannot be taken.
pub fn serve(
    address: SocketAddr,
    page: String,
    feed: &Arc<Feed>,
) -> std::result::Result<String, Error> {
    let taken = |e: &dyn std::fmt::Display| {
        let problem = format!("{address} cannot be served: {e}");
        let advice = "choose another port, or 0 for a free one";
        Error::one("E0003", Place::option("--serve"), problem, advice)
    };
    let server = Server::http(address).map_err(|e| taken(&e))?;
    let own = server.server_addr().to_ip().unwrap_or(address);
    let secret = match own.ip().is_loopback() {
        true => String::new(),
        false => format!("{:032x}/", secret_word().map_err(|e| taken(&e))?),
    };
    let path = format!("/{secret}");
    let shown = format!("http://{own}{path}");
    let feed = feed.clone();
    let thread = std::thread::Builder::new().spawn(move || {
        for request in server.incoming_requests() {
            answer(request, &path, &page, &feed);
        }
    });
    thread.map_err(|e| taken(&e))?;
    Ok(shown)
}

fn secret_word() -> std::result::Result<u128, getrandom::Error> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)?;
    Ok(u128::from_le_bytes(bytes))
}

fn answer(request: Request, path: &str, page: &str, feed: &Arc<Feed>) {
    let code = match request.url().strip_prefix(path) {
        Some(_) if !is_local(&request, path) => 403,
        Some("") => {
            let html = Response::from_string(page);
            let kind = Header::from_bytes("Content-Type", "text/html; charset=utf-8");
            let html = kind.into_iter().fold(html, Response::with_header);
            // A browser that goes away meets nobody.
            let _ = request.respond(html);
            return;
        }
        Some("events") if Arc::strong_count(&feed.browsers) <= BROWSERS => {
            let last = header(&request, "Last-Event-ID").and_then(|id| id.parse().ok());
            let next = last.map_or(0, |id: usize| id.saturating_add(1));
            let (guest, feed) = (feed.browsers.clone(), feed.clone());
            let stream = move || {
                feed.stream(request.into_writer(), next)
                    .map(|()| drop(guest))
            };
            let _ = std::thread::Builder::new().spawn(stream);
            return;
        }
        Some("events") => 503,
        _ => 404,
    };
    let _ = request.respond(Response::empty(code));
}

fn header(request: &Request, name: &'static str) -> Option<String> {
    let mut all = request.headers().iter();
    let found = all.find(|h| h.field.equiv(name))?;
    Some(found.value.as_str().to_owned())
}

/// Without a secret word, only who asks for this computer by its own name is answered: a page from elsewhere whose name leads here
/// reads nothing.
fn is_local(request: &Request, path: &str) -> bool {
    let host = header(request, "Host").unwrap_or_default();
    let name = host.rsplit_once(':').map_or(&*host, |(name, _)| name);
    path.len() > 1 || matches!(name, "127.0.0.1" | "localhost" | "[::1]")
}
