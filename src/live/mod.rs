//! A page on this machine that shows a picture while the text it is made of is being edited.
//!
//! ```text
//! files ──watch──▶ inbox ──▶ session ──▶ board ──▶ server ──▶ page
//! page ──server──▶   │          │  compiles, swaps groups, renders rounds
//!                    └─ stops ──┘
//! ```
//!
//! The session is one thread. It takes wishes from the inbox and renders rounds in between; a wish that makes the round worthless ends
//! it at once, in the middle of a shader too, any other one after the wave. What there is to see goes to the board, from where requests
//! take what is new; they wait there, so that nothing is asked for in vain.
//!
//! Decision (2026-11-30): tev gets whole pictures only, because it keeps an image's size and a coarse one in its place would flicker; the
//! page shows the coarse ones.
//!
//! Decision (2026-11-30): one request that waits for whatever is new, the picture's bytes with the words about it, instead of
//! WebSockets, which `tiny_http` does not do, and of server-sent events, which are text: a reader that is slow gets the newest picture and
//! misses those in between, and a browser's six connections suffice for five tabs.

mod board;
mod controls;
mod frame;
mod guard;
mod inbox;
mod page;
mod paths;
mod pixel;
mod server;
mod session;
mod showing;
mod source;
mod stages;
mod subject;
mod tev;
mod trial;
mod values;
mod watch;

pub use showing::Showing;
pub use source::Source;
pub use tev::{TEV_PORT, Tev};

use crate::render::Settings;
use board::Board;
use inbox::{Inbox, Wish};
use server::Desk;
use session::Session;
use std::fmt;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use tiny_http::Server;
use watch::Watched;

/// The port that is tried first when none is asked for.
pub const PORT: u16 = 7345;

/// A session with its page. It ends when it is dropped.
pub struct Live {
    address: SocketAddr,
    server: Arc<Server>,
    inbox: Arc<Inbox>,
    board: Arc<Board>,
}

/// Why there is no page.
#[derive(Debug)]
#[non_exhaustive]
pub enum LiveError {
    /// The port cannot be had.
    Port {
        /// Which.
        port: u16,
        /// Why not.
        reason: String,
    },
    /// Files cannot be watched.
    Watch(String),
    /// The settings cannot be rendered by.
    Settings(crate::render::SettingsError),
}

impl fmt::Display for LiveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LiveError::Port { port, reason } => {
                write!(f, "port {port} of 127.0.0.1 cannot be served: {reason}\n  help: take another one with --port")
            }
            LiveError::Watch(reason) => {
                write!(
                    f,
                    "files cannot be watched: {reason}\n  help: allow more watches (fs.inotify.max_user_instances)"
                )
            }
            LiveError::Settings(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for LiveError {}

impl fmt::Debug for Live {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Live").field("address", &self.address).finish_non_exhaustive()
    }
}

impl Live {
    /// Begins to render `source`, and serves its page on 127.0.0.1 alone.
    ///
    /// # Errors
    /// The port is taken, or files cannot be watched. What is wrong with the source is shown on the page.
    pub fn start(source: Source, settings: &Settings, showing: Showing) -> Result<Live, LiveError> {
        settings.check().map_err(LiveError::Settings)?;
        let (inbox, board): (Arc<Inbox>, Arc<Board>) = (Arc::default(), Arc::default());
        let watched = Watched::new(inbox.clone()).map_err(|error| LiveError::Watch(error.to_string()))?;
        let port = showing.port;
        let server = Arc::new(bound(port)?);
        let nowhere = || LiveError::Port { port: port.unwrap_or(PORT), reason: "it has no address".to_owned() };
        let address = server.server_addr().to_ip().ok_or_else(nowhere)?;
        let session = Session::new(source, settings.clone(), showing, (inbox.clone(), board.clone(), watched));
        std::thread::spawn(move || session.run());
        let desk = Desk { board: board.clone(), inbox: inbox.clone(), port: address.port() };
        let served = server.clone();
        std::thread::spawn(move || server::serve(&served, &desk));
        Ok(Live { address, server, inbox, board })
    }

    /// What is wrong with the source, if anything, as the page shows it.
    pub fn trouble(&self) -> Option<String> {
        self.board.text("status", "trouble")
    }

    /// The address of the page.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.inbox.push(Wish::Close);
        self.board.close();
        self.server.unblock();
    }
}

fn bound(port: Option<u16>) -> Result<Server, LiveError> {
    let at = |port: u16| {
        let told = |reason: String| LiveError::Port { port, reason };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|error| told(error.to_string()))?;
        send_at_once(&listener);
        Server::from_listener(listener, None).map_err(|error| told(error.to_string()))
    };
    match port {
        Some(port) => at(port),
        None => at(PORT).or_else(|_| at(0)),
    }
}

/// Has connections send what is written without waiting for more: they take it over from what listens on Linux. Else the end of each
/// picture waits 40 ms for the receipt of its beginning.
fn send_at_once(listener: &TcpListener) {
    #[cfg(target_os = "linux")]
    let _ = rustix::net::sockopt::set_tcp_nodelay(listener, true);
    let _ = listener;
}
