//! Pictures for tev (<https://github.com/Tom94/tev>), a viewer of floating-point images that listens on a port.
//!
//! A thread of its own sends the newest picture, linear as it is; those that come while it sends are passed over.

use crate::render::Image;
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

/// The port that tev listens on when nobody says otherwise.
pub const TEV_PORT: u16 = 14158;

/// How long tev may take to accept a connection, or a piece of a picture.
const PATIENCE: Duration = Duration::from_secs(5);

/// Characters of a name at most: a scene may be named by its text.
const NAME: usize = 200;

/// Numbers of a picture that are sent at a time.
const PIECE: usize = 1 << 20;

/// A viewer that pictures are sent to. What was shown last is there when it is dropped, or why not.
pub struct Tev {
    slot: Arc<Slot>,
    thread: Option<JoinHandle<()>>,
}

impl std::fmt::Debug for Tev {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Tev").finish_non_exhaustive()
    }
}

#[derive(Default)]
struct Slot {
    state: Mutex<State>,
    rings: Condvar,
}

#[derive(Default)]
struct State {
    next: Option<Image>,
    closed: bool,
    trouble: Option<String>,
}

impl Slot {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a picture; nothing when there will be none.
    fn next(&self) -> Option<Image> {
        let waits = |state: &mut State| state.next.is_none() && !state.closed;
        self.rings.wait_while(self.state(), waits).unwrap_or_else(PoisonError::into_inner).next.take()
    }
}

impl Tev {
    /// Connects to the tev that listens at `address`, `HOST:PORT` or `HOST` alone for its usual port, to show pictures as `name`.
    ///
    /// # Errors
    /// Nothing listens there; the text says what to do.
    pub fn connect(address: &str, name: &str) -> Result<Tev, String> {
        let address = if address.contains(':') { address.to_owned() } else { format!("{address}:{TEV_PORT}") };
        let told = |reason: String| {
            format!(
                "tev is not at {address}: {reason}\n  help: start it first; it listens on 127.0.0.1:{TEV_PORT}, or where its --hostname says"
            )
        };
        let socket = reach(&address).map_err(told)?;
        let slot = Arc::<Slot>::default();
        let mut link = Link {
            address,
            name: name.chars().filter(|c| *c != '\0').take(NAME).collect(),
            client: Some(TevClient::wrap(socket)),
            made: None,
        };
        let shared = slot.clone();
        let thread = std::thread::spawn(move || {
            while let Some(image) = shared.next() {
                let trouble = link.send(&image).err();
                shared.state().trouble =
                    trouble.map(|reason| format!("tev at {} shows no new picture: {reason}", link.address));
            }
        });
        Ok(Tev { slot, thread: Some(thread) })
    }

    /// Shows a picture, in place of the one before.
    pub fn show(&self, image: Image) {
        self.slot.state().next = Some(image);
        self.slot.rings.notify_all();
    }

    /// Why the last picture that was sent is not there; the next one tries anew.
    pub fn trouble(&self) -> Option<String> {
        self.slot.state().trouble.clone()
    }

    /// Waits until the last picture is there, and says why it is not.
    pub fn finish(mut self) -> Option<String> {
        self.close();
        self.trouble()
    }

    fn close(&mut self) {
        self.slot.state().closed = true;
        self.slot.rings.notify_all();
        // A thread that has panicked has nothing more to say.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

impl Drop for Tev {
    fn drop(&mut self) {
        self.close();
    }
}

/// A connection that can wait for tev, but not for ever.
fn reach(address: &str) -> Result<TcpStream, String> {
    let mut reason = "it is no address".to_owned();
    for at in address.to_socket_addrs().map_err(|error| error.to_string())? {
        let socket = TcpStream::connect_timeout(&at, PATIENCE);
        match socket.and_then(|socket| socket.set_write_timeout(Some(PATIENCE)).map(|()| socket)) {
            Ok(socket) => return Ok(socket),
            Err(error) => reason = error.to_string(),
        }
    }
    Err(reason)
}

/// The way to tev, and what it has of us.
struct Link {
    address: String,
    name: String,
    client: Option<TevClient>,
    /// Width, height and channels of the picture that was made there.
    made: Option<[usize; 3]>,
}

impl Link {
    fn send(&mut self, image: &Image) -> Result<(), String> {
        let mut client = match self.client.take() {
            Some(client) => client,
            None => {
                self.made = None;
                TevClient::wrap(reach(&self.address)?)
            }
        };
        self.send_by(&mut client, image).map_err(|error| error.to_string())?;
        // After a failure nobody knows how much of a packet was taken.
        self.client = Some(client);
        Ok(())
    }

    fn send_by(&mut self, client: &mut TevClient, image: &Image) -> std::io::Result<()> {
        let channels = &["R", "G", "B", "A"][..image.channels.min(4)];
        let (image_name, grab_focus) = (&self.name[..], false);
        let [width, height] = [image.width as usize, image.height as usize];
        if width * height * channels.len() == 0 {
            return Ok(());
        }
        let size = [width, height, channels.len()];
        if self.made != Some(size) {
            // In place of one of the same name.
            let (width, height) = (image.width, image.height);
            client.send(PacketCreateImage { image_name, grab_focus, width, height, channel_names: channels })?;
            self.made = Some(size);
        }
        let offsets: Vec<u64> = (0..channels.len() as u64).collect();
        let strides = vec![channels.len() as u64; channels.len()];
        let line = width * channels.len();
        let lines = (PIECE / line).max(1);
        for (piece, data) in image.pixels.chunks(lines * line).enumerate() {
            client.send(PacketUpdateImage {
                image_name,
                grab_focus,
                channel_names: channels,
                channel_offsets: &offsets,
                channel_strides: &strides,
                x: 0,
                y: (piece * lines) as u32,
                width: image.width,
                height: (data.len() / line) as u32,
                data,
            })?;
        }
        Ok(())
    }
}
