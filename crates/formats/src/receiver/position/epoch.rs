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

/// What an unfinished epoch consists of.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct State {
    /// What the messages of an epoch have in common: time of week, or time of day.
    pub key: Option<i64>,
    /// The messages so far, at most one of a kind, and a few of one that several talkers write.
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

    /// A message that several talkers write for one epoch, each with what it knows.
    pub(super) fn put_again(&mut self, key: i64, message: Message) -> Vec<Message> {
        let of_kind = self.state.messages.iter().filter(|each| each.kind == message.kind).count();
        if self.state.key != Some(key) || of_kind == 0 || of_kind >= TALKERS {
            return self.put(key, message);
        }
        // The third of a kind is another last message than the second.
        self.pass(key, message.kind | (of_kind as u32) << 24);
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
