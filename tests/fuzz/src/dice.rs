//! Chance that gives the same for the same seed, on every machine and with every version of a library.

/// SplitMix64 (Steele, Lea and Flood 2014).
#[derive(Clone, Debug)]
pub struct Dice(u64);

impl Dice {
    /// The dice of one case: of a seed, the name of a reader and a number.
    pub fn new(seed: u64, name: &str, index: u64) -> Self {
        // FNV-1a, so that readers get different cases.
        let name = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        let mut dice = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ name ^ index.rotate_left(32));
        dice.bits();
        dice
    }

    /// 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `count`; 0 for 0.
    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % (count.max(1) as u64)) as usize
    }

    /// True once in so many times.
    pub fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    /// One of these; they are never none.
    pub fn pick<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }

    /// From 0 to 1, 1 excluded.
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From −1 to 1.
    pub fn around(&mut self) -> f64 {
        2.0 * self.uniform() - 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_is_the_same_each_time_and_another_for_another_reader() {
        let numbers = |seed, name, index| {
            let mut dice = Dice::new(seed, name, index);
            [dice.bits(), dice.bits()]
        };
        assert_eq!(numbers(1, "urdf", 7), numbers(1, "urdf", 7));
        assert_ne!(numbers(1, "urdf", 7), numbers(1, "rig", 7));
        assert_ne!(numbers(1, "urdf", 7), numbers(2, "urdf", 7));
        assert_ne!(numbers(1, "urdf", 7), numbers(1, "urdf", 8));
    }

    #[test]
    fn numbers_stay_below_and_reach_all() {
        let mut dice = Dice::new(3, "", 0);
        let mut seen = [false; 5];
        for _ in 0..200 {
            seen[dice.below(5)] = true;
            assert!((0.0..1.0).contains(&dice.uniform()));
        }
        assert_eq!(seen, [true; 5]);
        assert_eq!(dice.below(0), 0);
    }
}
