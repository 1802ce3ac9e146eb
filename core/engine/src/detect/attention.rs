//! Which part of a live pair is looked at.
//!
//! What is grasped stands on the table, which takes up a small part of the images of both eyes. So
//! only the workspace is looked at, with what was seen beyond it, and now and then all that the lenses
//! show: a mount that is wrong, or a thing that comes in from elsewhere, leaves nothing unseen for
//! longer than some pairs. What was seen and is not seen again, and what reaches over the edge of what
//! is looked at, is looked for everywhere at once. Nothing that is shown is ever older than its pair.

use plumbline_model::detection::{Detection, PixelBox};
use plumbline_model::{Eye, StereoFrame, Workspace};
use plumbline_vision::detect::{Part, Region};

use super::view::{AllBecause, LookedAt};
use crate::live::{LiveSetup, fitting};

/// So many pairs in a row are looked at in part only.
pub const MOST_IN_PART: u32 = 7;
/// Around what was seen, so that it stays in view when it moves a little, px.
const AROUND_PX: f32 = 16.0;
/// By so much the edges of the workspace move while the head stands, px.
const STANDS_PX: u32 = 8;

/// Where the workspace is in both eyes, or why nobody can say.
pub type InView = Result<[Region; 2], AllBecause>;

/// What of a pair is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Looks {
    /// Of each eye.
    pub parts: [Part; 2],
    /// In words.
    pub at: LookedAt,
}

impl Looks {
    fn all(why: AllBecause) -> Self {
        Self { parts: [Part::Lit; 2], at: LookedAt::All(why) }
    }
}

/// What was seen when everything was looked at last, and what that says of the next pair.
#[derive(Debug, Default)]
pub struct Attention {
    in_part: u32,
    /// Of which source.
    opened: u64,
    /// `None`: everything is looked at next.
    last: Option<Everything>,
    /// Whether something is looked for.
    searching: bool,
}

/// What a look at everything saw.
#[derive(Debug)]
struct Everything {
    /// Where the workspace was.
    workspace: [Region; 2],
    /// Where things were seen in each eye.
    seen: [Vec<PixelBox>; 2],
}

impl Everything {
    /// How many of them lie beyond the workspace.
    fn beyond(&self) -> [usize; 2] {
        Eye::BOTH.map(Eye::index).map(|eye| count_beyond(self.workspace[eye], self.seen[eye].iter()))
    }

    /// The workspace as it is now, with all that was seen, on images of these sizes.
    fn with_seen(&self, mut workspace: [Region; 2], sizes_px: [(u32, u32); 2]) -> [Region; 2] {
        for ((region, seen), size) in workspace.iter_mut().zip(&self.seen).zip(sizes_px) {
            *region = seen.iter().fold(*region, |region, area| region.with(area, AROUND_PX, size));
        }
        workspace
    }
}

fn count_beyond<'a>(region: Region, seen: impl Iterator<Item = &'a PixelBox>) -> usize {
    seen.filter(|area| !region.holds(area)).count()
}

impl Attention {
    /// What to look at in both eyes, whose images are of these sizes.
    pub fn looks(&mut self, opened: u64, workspace: InView, sizes_px: [(u32, u32); 2]) -> Looks {
        if self.opened != opened {
            *self = Self { opened, ..Self::default() };
        }
        let all_because = match (&workspace, &self.last) {
            (Err(why), _) => Some(*why),
            (Ok(_), None) if self.searching => Some(AllBecause::Searching),
            (Ok(now), Some(last)) if last.beyond() != [0; 2] && is_moved(*now, last.workspace) => {
                Some(AllBecause::Searching)
            }
            (Ok(_), last) => {
                (last.is_none() || self.in_part >= MOST_IN_PART).then_some(AllBecause::NowAndThen)
            }
        };
        match (all_because, workspace, &self.last) {
            (None, Ok(now), Some(last)) => {
                self.in_part += 1;
                let regions = last.with_seen(now, sizes_px);
                let [left, right] = Eye::BOTH.map(Eye::index);
                let share = |eye: usize| regions[eye].share_of(sizes_px[eye]);
                let share = 0.5 * (share(left) + share(right));
                let at = LookedAt::Workspace { share, with_beyond: regions != now };
                Looks { parts: regions.map(Part::Region), at }
            }
            (why, ..) => {
                self.in_part = 0;
                Looks::all(why.unwrap_or(AllBecause::NowAndThen))
            }
        }
    }

    /// What a look has found, as far as it is shown.
    pub fn looked(&mut self, looks: &Looks, workspace: InView, shown: [&[Detection]; 2]) {
        let Ok(now) = workspace else { return self.forget() };
        let [Part::Region(left), Part::Region(right)] = looks.parts else {
            let seen = shown.map(|shown| shown.iter().map(|found| found.area).collect());
            self.last = Some(Everything { workspace: now, seen });
            self.searching = false;
            return;
        };
        let Some(last) = &self.last else { return };
        let beyond = last.beyond();
        let is_missed = |(eye, region): (Eye, Region)| {
            let shown = || shown[eye.index()].iter().map(|found| &found.area);
            let over_edge = shown().any(|area| !region.holds(area));
            over_edge || count_beyond(last.workspace[eye.index()], shown()) < beyond[eye.index()]
        };
        if Eye::BOTH.into_iter().zip([left, right]).any(is_missed) {
            self.last = None;
            self.searching = true;
        }
    }

    /// Looks at everything next.
    pub fn forget(&mut self) {
        self.last = None;
        self.searching = false;
    }
}

/// Whether the head has turned.
fn is_moved(now: [Region; 2], then: [Region; 2]) -> bool {
    let edges = |of: Region| [of.x_px, of.y_px, of.x_px + of.width_px, of.y_px + of.height_px];
    let moved = |(now, then): (Region, Region)| {
        edges(now).into_iter().zip(edges(then)).any(|(now, then)| now.abs_diff(then) > STANDS_PX)
    };
    now.into_iter().zip(then).any(moved)
}

/// Where the workspace is in both eyes.
///
/// # Errors
/// Why everything is looked at: the images are not those of the calibration, or the head looks
/// elsewhere.
pub fn workspace(frame: &StereoFrame, setup: &LiveSetup) -> InView {
    let cameras = &setup.calibration.cameras;
    fitting(frame, cameras).map_err(|_| AllBecause::Unknown)?;
    let described = setup.model.rig().workspace(&setup.posture);
    let workspace = Workspace { robot_from_left: setup.robot_from_left(), ..described };
    match Eye::BOTH.map(|eye| Region::of_workspace(cameras, &workspace, eye)) {
        [Some(left), Some(right)] => Ok([left, right]),
        _ => Err(AllBecause::OutOfView),
    }
}

#[cfg(test)]
mod tests {
    use plumbline_model::ClassIndex;

    use super::*;

    const REGION: Region = Region { x_px: 100, y_px: 200, width_px: 300, height_px: 150 };
    const WORKSPACE: InView = Ok([REGION; 2]);
    const SIZES_PX: [(u32, u32); 2] = [(640, 480); 2];

    fn thing(x_px: f32, y_px: f32) -> Detection {
        let area = PixelBox::new(x_px, y_px, x_px + 20.0, y_px + 20.0);
        Detection { class: ClassIndex(0), confidence: 0.9, area }
    }

    /// What is looked at in the next pair, of which the right eye sees this as far as it is looked at.
    fn look(attention: &mut Attention, workspace: InView, right: &[Detection]) -> Looks {
        let looks = attention.looks(1, workspace, SIZES_PX);
        let is_seen = |thing: &&Detection| match looks.parts[1] {
            Part::Region(region) => region.holds(&thing.area),
            _ => true,
        };
        let right: Vec<Detection> = right.iter().filter(is_seen).copied().collect();
        attention.looked(&looks, workspace, [&[thing(200.0, 250.0)], &right]);
        looks
    }

    /// Whether everything is looked at in so many pairs.
    fn looks(attention: &mut Attention, right: &[Detection], pairs: usize) -> Vec<bool> {
        (0..pairs).map(|_| look(attention, WORKSPACE, right).parts == [Part::Lit; 2]).collect()
    }

    #[test]
    fn all_is_looked_at_first_and_then_now_and_then() {
        let all = looks(&mut Attention::default(), &[], 18);
        let at: Vec<usize> = (0..18).filter(|pair| all[*pair]).collect();
        assert_eq!(at, [0, 8, 16]);
    }

    #[test]
    fn what_lies_beyond_the_workspace_is_looked_at_with_it() {
        let attention = &mut Attention::default();
        let beyond = thing(500.0, 100.0);
        assert_eq!(
            looks(attention, &[beyond], 9),
            [true, false, false, false, false, false, false, false, true]
        );
        let looked = look(attention, WORKSPACE, &[beyond]);
        let [Part::Region(left), Part::Region(right)] = looked.parts else { panic!("{looked:?}") };
        assert_eq!(left, REGION, "nothing is beyond there");
        assert!(right.holds(&beyond.area) && right.holds(&thing(100.0, 330.0).area), "{right:?}");
        let share = 0.5 * (left.share_of((640, 480)) + right.share_of((640, 480)));
        assert_eq!(looked.at, LookedAt::Workspace { share, with_beyond: true });
    }

    #[test]
    fn a_mount_that_is_wrong_hides_nothing_for_long() {
        // All that there is lies where nobody thinks the workspace is.
        let attention = &mut Attention::default();
        looks(attention, &[], 3);
        let came = [thing(30.0, 30.0)];
        let all = looks(attention, &came, 10);
        let found = all.iter().position(|all| *all).expect("everything is looked at");
        assert!(found < MOST_IN_PART as usize);
        let looked = look(attention, WORKSPACE, &came);
        assert!(matches!(looked.parts[1], Part::Region(region) if region.holds(&came[0].area)), "{looked:?}");
    }

    #[test]
    fn what_is_lost_or_comes_over_the_edge_is_looked_for_everywhere() {
        let attention = &mut Attention::default();
        assert_eq!(looks(attention, &[thing(500.0, 100.0)], 2), [true, false]);
        assert_eq!(looks(attention, &[thing(30.0, 100.0)], 2), [false, true], "it went elsewhere");
        let attention = &mut Attention::default();
        assert_eq!(looks(attention, &[], 2), [true, false]);
        let cut = thing(390.0, 250.0);
        let looked = attention.looks(1, WORKSPACE, SIZES_PX);
        attention.looked(&looked, WORKSPACE, [&[], &[cut]]);
        assert_eq!(look(attention, WORKSPACE, &[cut]).at, LookedAt::All(AllBecause::Searching));
        assert_eq!(looks(attention, &[cut], 3), [false; 3], "it is all in view now");
    }

    #[test]
    fn a_head_that_turns_loses_what_is_beyond() {
        let turned = Ok([Region { x_px: 140, ..REGION }; 2]);
        let attention = &mut Attention::default();
        looks(attention, &[], 1);
        assert!(look(attention, turned, &[]).parts != [Part::Lit; 2], "the workspace is where it is");
        let attention = &mut Attention::default();
        looks(attention, &[thing(500.0, 100.0)], 1);
        assert_eq!(look(attention, turned, &[]).at, LookedAt::All(AllBecause::Searching));
    }

    #[test]
    fn without_a_workspace_and_in_another_source_all_is_looked_at() {
        let mut attention = Attention::default();
        looks(&mut attention, &[], 2);
        let none = Err(AllBecause::OutOfView);
        assert_eq!(look(&mut attention, none, &[]).at, LookedAt::All(AllBecause::OutOfView));
        let looked = look(&mut attention, WORKSPACE, &[]);
        assert_eq!(looked.parts, [Part::Lit; 2], "nobody knows what was beyond");
        assert_eq!(looks(&mut attention, &[], 1), [false]);
        assert_eq!(attention.looks(2, WORKSPACE, SIZES_PX).parts, [Part::Lit; 2], "another source");
    }
}
