//! Which part of a live pair is looked at.
//!
//! What is grasped stands on the table, which takes up a small part of the images of both eyes. So
//! only the workspace is looked at, and now and then all that the lenses show; as long as that finds
//! something beyond the workspace, all of every pair is looked at. Nothing that is shown is ever older
//! than its pair, and nothing stays unseen for longer than some pairs.

use plumbline_model::detection::{Detection, PixelBox};
use plumbline_model::{Eye, StereoFrame, Workspace};
use plumbline_vision::detect::{Part, Region};

use crate::live::{LiveSetup, fitting};

/// So many pairs in a row are looked at in part only.
const MOST_IN_PART: u32 = 7;

/// What was looked at last, and what that says of the next pair.
#[derive(Debug, Default)]
pub struct Attention {
    in_part: u32,
    /// Whether the last look at everything saw nothing beyond the workspace.
    nothing_beyond: bool,
    /// Of which source.
    opened: u64,
}

impl Attention {
    /// What to look at in both eyes. `workspace` is where the workspace is in both of them, if that
    /// is known.
    pub fn parts(&mut self, opened: u64, workspace: Option<[Region; 2]>) -> [Part; 2] {
        if self.opened != opened {
            *self = Self { opened, ..Self::default() };
        }
        match workspace {
            Some(regions) if self.nothing_beyond && self.in_part < MOST_IN_PART => {
                self.in_part += 1;
                regions.map(Part::Region)
            }
            _ => {
                self.in_part = 0;
                [Part::Lit; 2]
            }
        }
    }

    /// What a look has found, as far as it is shown.
    pub fn looked(&mut self, parts: [Part; 2], workspace: Option<[Region; 2]>, shown: [&[Detection]; 2]) {
        let Some(regions) = workspace else {
            self.nothing_beyond = false;
            return;
        };
        if parts == [Part::Lit; 2] {
            let is_beyond = |(region, found): (Region, &[Detection])| {
                found.iter().any(|found| !holds(region, &found.area))
            };
            self.nothing_beyond = !regions.into_iter().zip(shown).any(is_beyond);
        }
    }

    /// Looks at everything next.
    pub fn forget(&mut self) {
        self.nothing_beyond = false;
    }
}

/// Where the workspace is in both eyes; `None` where the head looks elsewhere, or the images are not
/// those of the calibration.
pub fn workspace(frame: &StereoFrame, setup: &LiveSetup) -> Option<[Region; 2]> {
    let cameras = &setup.calibration.cameras;
    fitting(frame, cameras).ok()?;
    let described = setup.model.rig().workspace(&setup.posture);
    let workspace = Workspace { robot_from_left: setup.robot_from_left(), ..described };
    let [left, right] = Eye::BOTH.map(|eye| Region::of_workspace(cameras, &workspace, eye));
    Some([left?, right?])
}

/// Whether all of a box is in a region.
fn holds(region: Region, area: &PixelBox) -> bool {
    let (x0, y0) = (region.x_px as f32, region.y_px as f32);
    let (x1, y1) = (x0 + region.width_px as f32, y0 + region.height_px as f32);
    area.x0_px >= x0 && area.y0_px >= y0 && area.x1_px <= x1 && area.y1_px <= y1
}

#[cfg(test)]
mod tests {
    use plumbline_model::ClassIndex;

    use super::*;

    const REGION: Region = Region { x_px: 100, y_px: 200, width_px: 300, height_px: 150 };
    const WORKSPACE: Option<[Region; 2]> = Some([REGION; 2]);
    const PART: [Part; 2] = [Part::Region(REGION); 2];
    const ALL: [Part; 2] = [Part::Lit; 2];

    fn thing(x_px: f32, y_px: f32) -> Detection {
        let area = PixelBox::new(x_px, y_px, x_px + 20.0, y_px + 20.0);
        Detection { class: ClassIndex(0), confidence: 0.9, area }
    }

    /// What is looked at in so many pairs.
    fn looks(attention: &mut Attention, right: &[Detection], pairs: usize) -> Vec<bool> {
        let mut look = || {
            let parts = attention.parts(1, WORKSPACE);
            attention.looked(parts, WORKSPACE, [&[thing(200.0, 250.0)], right]);
            parts == ALL
        };
        (0..pairs).map(|_| look()).collect()
    }

    #[test]
    fn all_is_looked_at_first_and_then_now_and_then() {
        let all = looks(&mut Attention::default(), &[], 18);
        let at: Vec<usize> = (0..18).filter(|pair| all[*pair]).collect();
        assert_eq!(at, [0, 8, 16]);
    }

    #[test]
    fn what_lies_beyond_the_workspace_keeps_everything_in_view() {
        let attention = &mut Attention::default();
        assert_eq!(looks(attention, &[thing(390.0, 250.0)], 5), [true; 5], "over the edge in one eye");
        assert_eq!(looks(attention, &[], 2), [true, false], "until it is gone");
    }

    #[test]
    fn without_a_workspace_and_in_another_source_all_is_looked_at() {
        let mut attention = Attention::default();
        looks(&mut attention, &[], 2);
        assert_eq!(attention.parts(1, None), ALL);
        attention.looked(ALL, None, [&[], &[]]);
        assert_eq!(attention.parts(1, WORKSPACE), ALL, "nobody knows what was beyond");
        looks(&mut attention, &[], 2);
        assert_eq!(attention.parts(1, WORKSPACE), PART);
        assert_eq!(attention.parts(2, WORKSPACE), ALL);
    }
}
