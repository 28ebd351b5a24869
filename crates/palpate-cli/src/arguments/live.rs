// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate live`, and the options of the page that `palpate feel` has in common with it.

use std::net::IpAddr;
use std::path::PathBuf;

use clap::Args;

use super::ProfileChoice;
use super::numbers::{count, within};

/// The most contact points of a hand.
const MOST_POINTS: usize = 100;

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate live
  palpate live scenes/memoir_star.json
  palpate live scenes/cup.json --port 8000
  palpate live scenes/cup.json --device virtuose --points 10

The page is for this machine alone, and for who knows the token in its address. To reach it from
another machine, forward its port: ssh -L 8000:127.0.0.1:8000 NAME";

/// The options of `palpate live`.
#[derive(Args, Debug)]
pub(crate) struct LiveOptions {
    /// The scene file, which is watched, and can be saved; the built-in gallery if left out.
    pub(crate) scene: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) page: PageOptions,
    /// The device that is simulated: a name of `palpate devices`, or a JSON file as `palpate
    /// identify` writes it; omega if left out.
    #[arg(long, value_name = "DEVICE")]
    pub(crate) device: Option<ProfileChoice>,
    /// The contact points of the hand, where the scene's tool does not say how many; 10 on the
    /// built-in gallery, or else 1, if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = count(1, MOST_POINTS))]
    pub(crate) points: Option<usize>,
    /// Ticks a second [Hz].
    #[arg(long, allow_negative_numbers = true, default_value = "1000", value_parser = within(1.0, 100_000.0, "Hz"))]
    pub(crate) rate: f64,
}

/// Where the page is served.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub(crate) struct PageOptions {
    /// The port of the page; that of the scene's last run, or else any that is free, if left out.
    #[arg(long)]
    pub(crate) port: Option<u16>,
    /// The address of the page, for other machines to reach it. What it sends is not encrypted:
    /// who can read the network can move the hand. This machine alone if left out.
    #[arg(long, value_name = "ADDRESS")]
    pub(crate) bind: Option<IpAddr>,
    /// A file with the token of the page, 32 hexadecimal digits; written if it does not exist.
    #[arg(long, value_name = "FILE")]
    pub(crate) token_file: Option<PathBuf>,
}
