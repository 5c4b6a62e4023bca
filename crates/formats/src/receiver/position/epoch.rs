//! Messages of one epoch, until the last of them has come.

/// When an epoch is complete.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// At the first message of the next one: nothing that belongs to it is missed.
    WithNext,
    /// Also at the message that was the last of the epoch before it, for nobody waits for the next one.
    WithLast,
}

/// A message that waits for the others of its epoch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// Its number in the protocol.
    pub kind: u32,
    /// Its place in the stream, from 1.
    pub record: u64,
    /// Its content.
    pub body: Vec<u8>,
}

/// Talkers that write one message for one epoch, each constellation and all together (ours) \[1\].
pub(super) const TALKERS: usize = 4;

/// Messages of a kind beside the position that one epoch keeps: what states no epoch of its own may be written by each of many talkers, and
/// twice (ours) \[1\].
pub(super) const WITNESSES: usize = 16;

/// Messages that an unfinished epoch holds at most: of RMC, GLL, GNS and PUBX what is kept, GGA, GST and GBS of each talker, and one of a few more
/// kinds.
pub const MOST_MESSAGES: usize = 4 * WITNESSES + 3 * TALKERS + 8;

/// The bits of [`State::newest`] that are the kind.
const KIND: u32 = 0x00FF_FFFF;

/// What an unfinished epoch consists of.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct State {
    /// What the messages of an epoch have in common: time of week, or time of day.
    pub key: Option<i64>,
    /// The messages so far, at most one of a kind, and several of one that several talkers write.
    pub messages: Vec<Message>,
    /// Kind of the newest message of this epoch; in the highest byte how many of its kind came before it, where talkers share one.
    pub newest: u32,
    /// Kind of the last message of the epoch before.
    pub last: u32,
    /// The epoch that was finished at its last message by habit.
    pub finished: Option<i64>,
    /// A message came behind its finished epoch: the source has no habit, and every epoch waits for the next one.
    pub waits: bool,
}

/// Messages of one epoch.
#[derive(Debug, Clone)]
pub(super) struct Epoch {
    pub(super) state: State,
    pub(super) ends: Ends,
}

impl Epoch {
    /// A message of the epoch `key`; the messages of the epoch before it, if this begins another. A second message of a kind does.
    pub(super) fn put(&mut self, key: i64, message: Message) -> Vec<Message> {
        let state = &mut self.state;
        let again = state.messages.iter().any(|each| each.kind == message.kind);
        // What came without a time behind a finished epoch is of the next one.
        let finished = state.key.is_none();
        let complete = if (state.key != Some(key) && !finished) || again { std::mem::take(&mut state.messages) } else { Vec::new() };
        self.pass(key, message.kind);
        self.state.messages.push(message);
        complete
    }

    /// A message that several talkers write for one epoch, each with what it knows; one more than `most` begins another epoch.
    pub(super) fn put_again(&mut self, key: i64, message: Message, most: usize) -> Vec<Message> {
        let of_kind = self.state.messages.iter().filter(|each| each.kind == message.kind).count();
        if self.state.key != Some(key) || of_kind == 0 || of_kind >= most {
            return self.put(key, message);
        }
        // The third of a kind is another last message than the second.
        self.pass(key, message.kind | (of_kind as u32) << KIND.count_ones());
        self.state.messages.push(message);
        Vec::new()
    }

    /// A message without a time of its own: of the unfinished epoch, and one of a kind. Where an epoch was finished before it came, it counts for
    /// the next one.
    pub(super) fn put_beside(&mut self, message: Message, better: impl Fn(&Message, &Message) -> bool) {
        match self.state.messages.iter_mut().find(|each| each.kind == message.kind) {
            Some(kept) if better(&message, kept) => *kept = message,
            Some(_) => {}
            None => self.state.messages.push(message),
        }
    }

    /// A message of the epoch `key` that is not kept.
    pub(super) fn pass(&mut self, key: i64, kind: u32) {
        if self.state.key != Some(key) {
            self.state.waits |= self.state.finished == Some(key);
            (self.state.key, self.state.last) = (Some(key), self.state.newest);
        }
        self.state.newest = kind;
    }

    /// A further message of a kind of which the epoch keeps no more: each is another last message than the one before it.
    pub(super) fn pass_again(&mut self, key: i64, kind: u32) {
        let of_kind = |newest: u32| newest & KIND == kind;
        let n_before = if of_kind(self.state.newest) { (self.state.newest >> KIND.count_ones()) + 1 } else { WITNESSES as u32 };
        self.pass(key, kind | n_before.min(u32::from(u8::MAX)) << KIND.count_ones());
    }

    /// Whether the newest message was the last by habit.
    pub(super) fn at_last(&self) -> bool {
        self.ends == Ends::WithLast && !self.state.waits && self.state.key.is_some() && self.state.newest == self.state.last
    }

    /// What there is: the epoch is finished.
    pub(super) fn take(&mut self) -> Vec<Message> {
        self.state.finished = self.state.key.take().or(self.state.finished);
        std::mem::take(&mut self.state.messages)
    }
}

/// The message of a kind.
pub(super) fn of_kind(messages: &[Message], kind: u32) -> Option<&Message> {
    all_of_kind(messages, kind).next()
}

/// All messages of a kind.
pub(super) fn all_of_kind(messages: &[Message], kind: u32) -> impl Iterator<Item = &Message> {
    messages.iter().filter(move |message| message.kind == kind)
}
