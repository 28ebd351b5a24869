// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The thread that reads what pages say, and hands it to who does it.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError};

use super::Shared;
use super::editor::Edit;
use super::inquiry::Asked;
use super::pages::{PageId, Received, Work};
use super::performance::Order;
use super::stop::{Presser, Stop};
use crate::wire::{Ask, Envelope, Kind, Question, Unreadable};

/// Why a message is refused for which there is no room.
const BUSY: &str = "the program is busy with what was asked before: ask again";

/// Hands messages on.
#[derive(Debug)]
pub(super) struct Dispatcher {
    pub(super) orders: SyncSender<Order>,
    pub(super) edits: SyncSender<Edit>,
    pub(super) stop: Arc<Stop>,
    pub(super) shared: Shared,
}

impl Dispatcher {
    pub(super) fn run(self, messages: &Receiver<Received>) {
        // It ends with the stage.
        while let Ok(message) = messages.recv() {
            self.shared.watch.begins(Work::Message);
            self.take(message);
        }
    }

    fn take(&self, message: Received) {
        let (page, length) = (message.page, message.text.len());
        let Envelope { id, kind } = match Envelope::read(&message.text) {
            Ok(envelope) => envelope,
            Err(Unreadable { id, why }) => return self.shared.pages.not_read(page, id, &why),
        };
        if length > kind.longest() {
            let why =
                format!("such a message has at most {} bytes, got {length}", kind.longest());
            return self.shared.pages.refuse(page, id, &why, &[]);
        }
        let is_full = match kind {
            Kind::Stop => {
                self.stop.press(Presser::Page(page, message.text.clone()));
                false
            }
            Kind::Order => match message.read() {
                Ok(question) => self.order(page, question),
                Err(Unreadable { id, why }) => {
                    return self.shared.pages.not_read(page, id, &why);
                }
            },
            Kind::Edit => is_full(self.edits.try_send(Edit::Asked(message))),
            Kind::Short | Kind::Long => {
                self.shared.inquiries.take(Asked { message, id, is_short: kind == Kind::Short })
            }
        };
        if is_full {
            self.shared.pages.refuse(page, id, BUSY, &[]);
        }
    }

    /// Does what is done at once; whether there is no room for it.
    fn order(&self, page: PageId, Question { id, ask }: Question) -> bool {
        let order = match ask {
            Ask::Release { number } => Order::Release { page, id, number },
            Ask::Hand { target: Some(target), point, from, held: true } => {
                Order::Lead { page, id, target, point, from }
            }
            Ask::Hand { held: false, .. } => return self.done(page, id, Order::LetGo),
            Ask::Hand { target: None, .. } => {
                self.shared.pages.refuse(page, id, "a hand that is held has a target", &[]);
                return false;
            }
            Ask::Tour { on } => return self.done(page, id, Order::Tour(on)),
            Ask::Clock { speed, step } => Order::Clock { page, id, speed, step },
            Ask::Record { on } => return self.done(page, id, Order::Record(on)),
            Ask::Replay { on } => Order::Replay { page, id, on },
            Ask::Hidden { is } => {
                self.shared.pages.hide(page, is);
                self.shared.pages.done(page, id);
                return false;
            }
            Ask::Cancel { question } => {
                if self.shared.inquiries.cancel(page, question, &self.shared.pages) {
                    self.shared.pages.done(page, id);
                } else {
                    let why = format!("no question of number {question} is worked on");
                    self.shared.pages.refuse(page, id, &why, &[]);
                }
                return false;
            }
            _ => return false,
        };
        is_full(self.orders.try_send(order))
    }

    /// Gives an order that cannot be refused; whether there is no room for it.
    fn done(&self, page: PageId, id: Option<u32>, order: Order) -> bool {
        let is_full = is_full(self.orders.try_send(order));
        if !is_full {
            self.shared.pages.done(page, id);
        }
        is_full
    }
}

fn is_full<T>(sent: Result<(), TrySendError<T>>) -> bool {
    sent.is_err()
}
