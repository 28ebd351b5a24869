// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A server in a thread.

use std::fmt;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use palpate::device::{DeviceProfile, profile_named};
use palpate::haptics::StopSwitch;

use crate::server::{self, Server};
use crate::stage::{GivenClock, MOST_POINTS, Program, Refusal, Stage, Unsaved, Watch};

/// The device of the page unless another is chosen.
const DEVICE: &str = "omega";

/// How a page is served.
///
/// ```
/// use palpate_live::LiveOptions;
///
/// let options = LiveOptions { port: 8000, points: 2, ..LiveOptions::default() };
/// assert_eq!(options.rate, 1000.0);
/// ```
#[derive(Clone, Debug)]
pub struct LiveOptions {
    /// The address to listen at. Other machines reach any but a loopback address, without encryption.
    pub address: IpAddr,
    /// The port; 0 for any that is free.
    pub port: u16,
    /// 32 hexadecimal digits that a page must know; random ones if `None`.
    pub token: Option<String>,
    /// The device that is simulated; the omega if `None`.
    pub device: Option<DeviceProfile>,
    /// Ticks a second [Hz].
    pub rate: f64,
    /// The contact points of the hand, where the scene's tool does not say how many.
    pub points: usize,
    /// The clock of the servo that the first page begins: a test gives a virtual one, and so knows its ticks. The
    /// machine's clock by default.
    pub clock: GivenClock,
    /// The emergency stop of the servo. A signal handler or a button may press it too.
    pub stop: StopSwitch,
    /// Called by each thread that begins to work: a test holds the thread there. The threads of the servo and of the
    /// sockets call nothing.
    pub watch: Watch,
}

impl Default for LiveOptions {
    /// This machine alone, any port, a random token; an omega at 1 kHz, one contact point.
    fn default() -> Self {
        Self {
            address: IpAddr::V4(Ipv4Addr::LOCALHOST),
            port: 0,
            token: None,
            device: None,
            rate: 1000.0,
            points: 1,
            clock: GivenClock::default(),
            stop: StopSwitch::new(),
            watch: Watch::default(),
        }
    }
}

/// Why a page is not served.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LiveError {
    /// The scene has an error.
    #[error("{0}")]
    Scene(String),
    /// There are more contact points than a page's hand has.
    #[error("the hand of a page has at most {MOST_POINTS} contact points, got {0}")]
    Points(usize),
    /// The rate is not positive and finite [Hz].
    #[error("the rate must be positive and finite, got {0} Hz")]
    Rate(f64),
    /// The address cannot be listened at.
    #[error("cannot listen at {address}: {error}{}", hint(error))]
    Address {
        /// The address.
        address: SocketAddr,
        /// What the operating system says.
        error: std::io::Error,
    },
    /// The token is not 32 hexadecimal digits.
    #[error("a token is 32 hexadecimal digits, got {0} characters")]
    Token(usize),
    /// The operating system gives no thread or no random numbers.
    #[error("the page cannot be served: {0}")]
    System(String),
}

/// What helps where an address cannot be listened at.
fn hint(error: &std::io::Error) -> &'static str {
    match error.kind() {
        std::io::ErrorKind::AddrInUse => {
            "; another program listens there: end it, or take another port, 0 for any that is free"
        }
        std::io::ErrorKind::PermissionDenied => "; take a port of 1024 or more",
        std::io::ErrorKind::AddrNotAvailable => "; this machine has no such address",
        _ => "",
    }
}

/// A page that is served, until this is dropped: then forces are zero and sockets closed.
pub struct Live {
    address: SocketAddr,
    token: String,
    stop: StopSwitch,
    stage: Arc<Stage>,
    server: Option<Server>,
}

impl Live {
    /// Serves a scene with this name, of `file` if it came from one, which is then watched and can
    /// be saved.
    ///
    /// # Errors
    ///
    /// If the scene has an error, an option is out of its range, or the address cannot be listened at.
    pub fn start(
        name: impl Into<String>,
        file: Option<PathBuf>,
        scene: &str,
        options: LiveOptions,
    ) -> Result<Self, LiveError> {
        let LiveOptions { address, port, token, device, rate, points, clock, stop, watch } =
            options;
        if points > MOST_POINTS {
            return Err(LiveError::Points(points));
        }
        // Written so that NaN is refused.
        if !(rate > 0.0 && rate.is_finite()) {
            return Err(LiveError::Rate(rate));
        }
        let system = |error: &dyn fmt::Display| LiveError::System(error.to_string());
        let token = match token {
            None => server::new_token().map_err(|error| system(&error))?,
            Some(token) if server::is_token(&token) => token,
            Some(token) => return Err(LiveError::Token(token.chars().count())),
        };
        let profile = device.map_or_else(|| profile_named(DEVICE), Ok);
        let profile = profile.map_err(|error| system(&error))?;
        let (name, text) = (name.into(), scene.to_owned());
        let program = Program {
            name,
            file,
            text,
            profile,
            rate,
            points,
            clock,
            stop: stop.clone(),
            watch,
        };
        let stage =
            Stage::new(program).map_err(|Refusal { message, .. }| LiveError::Scene(message))?;
        let stage = Arc::new(stage);
        let address = SocketAddr::new(address, port);
        let failed = |error| LiveError::Address { address, error };
        let listener = server::listener(address).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let server = Server::start(listener, address, token.clone(), &stage);
        let server = Some(server.map_err(|error| system(&error))?);
        Ok(Self { address, token, stop, stage, server })
    }

    /// The address to open, with the token. Of a page that listens at all addresses of this machine, it
    /// is that by which others reach it, if there is one.
    #[must_use]
    pub fn url(&self) -> String {
        let mut address = self.address;
        if address.ip().is_unspecified() {
            address.set_ip(outward(address.ip()));
        }
        format!("http://{address}/#{}", self.token)
    }

    /// The address that is listened at.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// The token that a page must know.
    #[must_use]
    pub fn token(&self) -> &str {
        &self.token
    }

    /// The emergency stop of whatever servo runs.
    #[must_use]
    pub fn stop_switch(&self) -> StopSwitch {
        self.stop.clone()
    }

    /// The scene with its edits, if they are not saved. Edits that wait are made first, as far as that
    /// takes no longer than `patience`.
    #[must_use]
    pub fn unsaved(&self, patience: Duration) -> Option<Unsaved> {
        self.stage.unsaved(patience)
    }

    /// The number of pages that are open.
    #[must_use]
    pub fn pages(&self) -> usize {
        self.stage.pages.count()
    }

    /// Whether a page ever was open.
    #[must_use]
    pub fn was_opened(&self) -> bool {
        self.stage.pages.ever() > 0
    }
}

/// The address from which this machine would send to others; the loopback address if it has no way to
/// them. Nothing is sent.
fn outward(any: IpAddr) -> IpAddr {
    let (elsewhere, loopback): (IpAddr, IpAddr) = match any {
        // Addresses for documentation, which nobody has.
        IpAddr::V4(_) => (Ipv4Addr::new(192, 0, 2, 1).into(), Ipv4Addr::LOCALHOST.into()),
        IpAddr::V6(_) => {
            let documentation = Ipv6Addr::new(0x2001, 0xdb8, 0, 0, 0, 0, 0, 1);
            (documentation.into(), Ipv6Addr::LOCALHOST.into())
        }
    };
    let asked = UdpSocket::bind((any, 0)).and_then(|socket| {
        socket.connect((elsewhere, 9))?;
        socket.local_addr()
    });
    asked.map_or(loopback, |address| address.ip())
}

impl Drop for Live {
    fn drop(&mut self) {
        // First forces are zero.
        self.stage.end();
        drop(self.server.take());
    }
}

impl fmt::Debug for Live {
    /// Without the token, which may be logged.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Live").field("address", &self.address).finish_non_exhaustive()
    }
}
