//! One cycle's conversation with all servos: readings in, within a deadline.

use std::time::{Duration, Instant};

use super::servo_unit::ServoUnit;
use super::slot::{Identity, Slot};
use crate::dynamixel::{BulkItem, Bus, BusError, FaultKind, Instruction, Item};

/// The first attempt of a cycle waits as long as answers take at the moment.
const FIRST_ATTEMPT: Duration = Duration::from_millis(100);
/// When nobody answers, so many are asked singly before the line counts as dead.
const DEAD_AFTER: usize = 2;
/// A servo that was given up is asked again every so many cycles …
const ASK_AGAIN: u64 = 32;
/// … and where they are long, so often at least: a busy machine must not take what answers again for silent.
const ASK_AGAIN_WITHIN: Duration = Duration::from_millis(500);
/// A servo that is not heard, not even late, is silent after this time at the latest, however busy this machine is: it is
/// named within a second.
const LONGEST_SILENCE: Duration = Duration::from_millis(600);
/// Cycles with an answer to a single read but none to the bulk read after which it is read singly.
const NO_BULK: u32 = 30;

/// When a servo counts as silent: not by one lost answer, nor by a pause of this machine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Silence {
    /// Cycles in a row in which it was asked in vain.
    pub cycles: u32,
    /// And time without an answer.
    pub time: Duration,
}

/// All servos of a rig on a bus.
#[derive(Debug)]
pub(super) struct Exchange {
    pub bus: Bus,
    pub slots: Vec<Slot>,
    /// Largest speed of a joint, rad/s; servos are told a little more.
    pub speed_rad_s: f64,
    /// No goal lies farther than this from the angle just read, rad.
    pub step_rad: f64,
    pub silence: Silence,
    pub(super) turn: u64,
    /// When who was left out was asked last, in which cycle, and how many were by then.
    asked_silent: (Instant, u64, usize),
}

impl Exchange {
    pub fn new(bus: Bus, units: Vec<ServoUnit>, speed_rad_s: f64, step_rad: f64, silence: Silence) -> Self {
        let slots = units.into_iter().map(Slot::new).collect();
        let asked_silent = (Instant::now(), 0, 0);
        Self { bus, slots, speed_rad_s, step_rad, silence, turn: 0, asked_silent }
    }

    /// Reads every servo in use once, repeats what failed until `deadline`. What is read last is what
    /// moves most, so that a goal that follows at once rests on a fresh angle. Returns whether all
    /// answered.
    pub fn read_all(&mut self, deadline: Instant) -> Result<bool, BusError> {
        self.turn += 1;
        self.ask_silent()?;
        self.read_slow()?;
        let mut open: Vec<usize> = vec![];
        let singles = self.singles();
        let asked = self.read_singles(&singles, deadline, &mut open)?;
        self.read_bulk(&mut open)?;
        if self.nobody_answered() {
            return self.note_dead_line();
        }
        self.read_singles(&singles[asked..], deadline, &mut open)?;
        if Instant::now() >= deadline {
            self.ask_one_more(&singles, &mut open)?;
        }
        for _ in 1..self.bus.timing().attempts {
            for i in std::mem::take(&mut open) {
                if Instant::now() >= deadline || !self.slots[i].in_use() {
                    open.push(i);
                    continue;
                }
                self.bus.count_retry();
                if self.read_one(i, deadline, &mut open)? && !self.slots[i].reads_singly {
                    self.slots[i].no_bulk += 1;
                    self.slots[i].reads_singly = self.slots[i].no_bulk >= NO_BULK;
                }
            }
        }
        // Only who was asked for itself is to blame; who merely stood behind a silent one in the
        // bulk read, or was not reached in time, is not.
        for i in open {
            if self.slots[i].asked_in == self.turn {
                self.slots[i].miss();
            }
        }
        self.verify(deadline)?;
        self.note_silence();
        let turn = self.turn;
        Ok(self.slots.iter().all(|slot| !slot.in_use() || slot.read_in == turn))
    }

    /// However slow the line is, one of those that gave no answer has its turn in each cycle, who was
    /// read longest ago first: else nobody would ever be asked for itself, and a silent one that cuts
    /// off the bulk read never be noticed.
    fn ask_one_more(&mut self, singles: &[usize], open: &mut Vec<usize>) -> Result<(), BusError> {
        let missed = singles.iter().copied().filter(|i| self.slots[*i].missed > 0);
        let rest = open.iter().copied().chain(missed).filter(|i| self.slots[*i].asked_in != self.turn);
        let next = rest.min_by_key(|i| (self.slots[*i].read_in, self.slots[*i].asked_in));
        if let Some(i) = next {
            open.retain(|other| *other != i);
            self.read_one(i, Instant::now() + FIRST_ATTEMPT, open)?;
        }
        Ok(())
    }

    /// Who is read singly: first those that answer, each cycle beginning with another, so that who is
    /// silent takes nobody else's time.
    fn singles(&self) -> Vec<usize> {
        let is_single = |slot: &Slot| slot.in_use() && (slot.reads_singly || slot.missed > 0);
        let mut singles: Vec<usize> = (0..self.slots.len()).filter(|i| is_single(&self.slots[*i])).collect();
        if !singles.is_empty() {
            let begin = self.turn as usize % singles.len();
            singles.rotate_left(begin);
        }
        singles.sort_by_key(|i| self.slots[*i].missed > 0);
        singles
    }

    /// Reads them until `deadline`, or until it seems that nobody answers at all. Returns how many
    /// were asked.
    fn read_singles(
        &mut self,
        singles: &[usize],
        deadline: Instant,
        open: &mut Vec<usize>,
    ) -> Result<usize, BusError> {
        for (asked, i) in singles.iter().enumerate() {
            if Instant::now() >= deadline || (asked >= DEAD_AFTER && self.nobody_answered()) {
                return Ok(asked);
            }
            self.read_one(*i, Instant::now() + FIRST_ATTEMPT, open)?;
        }
        Ok(singles.len())
    }

    fn nobody_answered(&self) -> bool {
        let (turn, mut in_use) = (self.turn, self.slots.iter().filter(|slot| slot.in_use()).peekable());
        in_use.peek().is_some() && in_use.all(|slot| slot.read_in != turn)
    }

    /// Some were asked singly and all others at once, and nobody answered: that counts for all.
    fn note_dead_line(&mut self) -> Result<bool, BusError> {
        self.slots.iter_mut().filter(|slot| slot.in_use()).for_each(Slot::miss);
        self.note_silence();
        Ok(false)
    }

    fn read_bulk(&mut self, open: &mut Vec<usize>) -> Result<(), BusError> {
        let is_bulk = |slot: &Slot| slot.in_use() && !slot.reads_singly && slot.missed == 0;
        let bulk: Vec<usize> = (0..self.slots.len()).filter(|i| is_bulk(&self.slots[*i])).collect();
        let items: Vec<BulkItem> = bulk.iter().map(|i| self.item(*i)).collect();
        let answers = self.bus.bulk_read(&items, Instant::now() + FIRST_ATTEMPT)?;
        let first_open = open.len();
        for (i, answer) in bulk.iter().zip(answers) {
            match answer {
                Ok(status) => {
                    self.slots[*i].take(&status, self.turn);
                    self.slots[*i].no_bulk = 0;
                }
                Err(_) => open.push(*i),
            }
        }
        // The first of them is who kept the others waiting: they are asked before it. But whoever was
        // not reached for longest comes first, or where time is short its turn would never come.
        if open.len() > first_open {
            open[first_open..].rotate_left(1);
            open[first_open..].sort_by_key(|i| self.slots[*i].read_in);
        }
        Ok(())
    }

    pub(super) fn item(&self, i: usize) -> BulkItem {
        let unit = &self.slots[i].unit;
        BulkItem { id: unit.id(), address: unit.block.0, length: unit.block.1 }
    }

    fn read_one(&mut self, i: usize, deadline: Instant, open: &mut Vec<usize>) -> Result<bool, BusError> {
        let BulkItem { id, address, length } = self.item(i);
        self.slots[i].asked_in = self.turn;
        let instruction = Instruction::Read { address, length };
        match self.bus.ask_once(id, &instruction, Some(usize::from(length)), deadline)? {
            Ok(status) => {
                self.slots[i].take(&status, self.turn);
                Ok(true)
            }
            Err(_) => {
                open.push(i);
                Ok(false)
            }
        }
    }

    /// Asks one of the silent who it is; each has its turn twice a second. Who it is comes first: it
    /// may have been exchanged.
    fn ask_silent(&mut self) -> Result<(), BusError> {
        let silent: Vec<usize> =
            (0..self.slots.len()).filter(|i| self.slots[*i].silent && !self.slots[*i].is_barred()).collect();
        if silent.is_empty() {
            return Ok(());
        }
        let every = (ASK_AGAIN / silent.len() as u64).max(1);
        let (asked_at, asked_in, asked) = self.asked_silent;
        let within = ASK_AGAIN_WITHIN.div_f64(silent.len() as f64);
        if self.turn - asked_in < every && asked_at.elapsed() < within {
            return Ok(());
        }
        self.asked_silent = (Instant::now(), self.turn, asked.wrapping_add(1));
        let i = silent[asked % silent.len()];
        let id = self.slots[i].unit.id();
        let deadline = Instant::now() + FIRST_ATTEMPT;
        if let Ok(found) = self.bus.identify_once(id, deadline)? {
            self.slots[i].identified(found);
            if self.slots[i].identity == Identity::Right {
                self.read_one(i, deadline, &mut vec![])?;
            }
        } else {
            self.slots[i].in_vain = self.slots[i].in_vain.saturating_add(1);
        }
        Ok(())
    }

    /// Who missed a question and answers again is asked who it is before anything is written to it.
    fn verify(&mut self, deadline: Instant) -> Result<(), BusError> {
        for i in 0..self.slots.len() {
            let slot = &self.slots[i];
            let due = slot.in_use() && slot.verify && slot.read_in == self.turn;
            if !due || Instant::now() >= deadline {
                continue;
            }
            let id = slot.unit.id();
            if let Ok(found) = self.bus.identify_once(id, deadline)? {
                self.slots[i].identified(found);
            }
        }
        Ok(())
    }

    fn note_silence(&mut self) {
        let Silence { cycles, time } = self.silence;
        // Where answers came late lately, the next ones are waited for as much longer.
        let time = time.mul_f64(self.bus.patience()).min(LONGEST_SILENCE.max(time));
        for slot in &mut self.slots {
            let by_servo = &self.bus.counts().by_servo;
            let late = by_servo.get(&slot.unit.id()).map_or(0, |counts| counts.of(FaultKind::Late));
            slot.note_late(late);
            // Who answers too late is there: this machine is busy, and neither power nor cable is gone.
            if slot.missed >= cycles && slot.silence() >= time && !slot.answers_late() {
                slot.fall_silent();
            }
        }
    }

    /// Takes the answers of a conversation that was interrupted: they tell where the joints are now.
    pub fn take_late(&mut self, longest: Duration) -> Result<(), BusError> {
        for status in self.bus.let_come(longest)? {
            let turn = self.turn;
            let is_its = |slot: &&mut Slot| {
                slot.in_use()
                    && slot.unit.id() == status.id
                    && usize::from(slot.unit.block.1) == status.data.len()
                    && slot.read_in != turn
            };
            if let Some(slot) = self.slots.iter_mut().find(is_its) {
                slot.take(&status, turn);
            }
        }
        Ok(())
    }

    /// The current of one servo in every other cycle, round and round.
    fn read_slow(&mut self) -> Result<(), BusError> {
        let n = self.slots.len() as u64;
        if n == 0 || !self.turn.is_multiple_of(2) {
            return Ok(());
        }
        let i = (self.turn / 2 % n) as usize;
        let slot = &self.slots[i];
        let Some(register) = slot.unit.table.register(Item::PresentCurrent).copied() else { return Ok(()) };
        if !slot.in_use() || slot.missed > 0 {
            return Ok(());
        }
        let instruction = Instruction::Read { address: register.address, length: register.size };
        let soon = Instant::now() + Duration::from_millis(10);
        let answer =
            self.bus.ask_once(slot.unit.id(), &instruction, Some(usize::from(register.size)), soon)?;
        let raw = answer.ok().and_then(|status| register.in_data(register.address, &status.data));
        if let Some(raw) = raw {
            self.slots[i].reading.current_a = Some(register.si(raw));
        }
        Ok(())
    }
}
