//! The keys of a rig file: which there are, and which must be there.

/// A table of the file.
pub(super) struct Keys {
    /// Its key in the table around it.
    pub name: &'static str,
    /// Whether it must be there.
    pub needed: bool,
    /// What it is for, where it is needed: "eyes", which the program sees with.
    pub purpose: &'static str,
    /// Keys that must be there.
    pub required: &'static [&'static str],
    /// Keys that may be there.
    pub optional: &'static [&'static str],
    /// Tables inside of it.
    pub inside: &'static [Keys],
}

impl Keys {
    const fn needed(name: &'static str, purpose: &'static str, required: &'static [&'static str]) -> Self {
        Self { name, needed: true, purpose, required, optional: &[], inside: &[] }
    }

    const fn optional(name: &'static str, required: &'static [&'static str]) -> Self {
        Self { needed: false, ..Self::needed(name, "", required) }
    }

    /// All keys, for people.
    pub fn list(&self) -> String {
        let own = self.required.iter().chain(self.optional).copied();
        own.chain(self.inside.iter().map(|inside| inside.name)).collect::<Vec<_>>().join(", ")
    }

    /// Whether there is such a key.
    pub fn know(&self, key: &str) -> bool {
        let own = self.required.iter().chain(self.optional).copied();
        own.chain(self.inside.iter().map(|inside| inside.name)).any(|known| known == key)
    }
}

const LENS: &[&str] = &["width_px", "height_px", "fx_px", "fy_px", "cx_px", "cy_px", "skew_px", "k"];

/// All of the file.
pub(super) const FILE: Keys = Keys {
    inside: &[
        Keys::needed("bus", "how fast the servos are talked to", &["baud"]),
        Keys::needed(
            "gate",
            "what is too hot, too heavy, too fast and too low",
            &["warm_c", "hot_c", "load", "speed_rad_s", "usual_speed_rad_s", "step_rad", "floor_m"],
        ),
        Keys::needed("table", "the top of the table", &["height_m", "x_range_m", "y_range_m"]),
        Keys::needed("workspace", "where on the table is worked", &["x_range_m", "y_range_m", "headroom_m"]),
        Keys::needed(
            "touchscreen",
            "the screen that the finger touches",
            &["width_px", "height_px", "width_m", "height_m", "origin_m", "u_axis", "v_axis"],
        ),
        Keys {
            inside: &[
                Keys::needed("left", "the lens of the left camera", LENS),
                Keys::needed("right", "the lens of the right camera", LENS),
            ],
            ..Keys::needed(
                "eyes",
                "the two cameras in the head",
                &[
                    "link",
                    "pan",
                    "tilt",
                    "left_position_m",
                    "left_rotation_rad",
                    "right_from_left_rotation_rad",
                    "right_from_left_translation_m",
                ],
            )
        },
        Keys::needed(
            "servo",
            "a servo for every joint that is driven",
            &[
                "id",
                "model",
                "joint",
                "title",
                "direction",
                "offset_rad",
                "ratio",
                "motor_lower_rad",
                "motor_upper_rad",
            ],
        ),
        Keys::optional("board", &["id", "model", "title"]),
        Keys::optional("coupled_limit", &["joint", "by", "why", "table_rad"]),
        Keys {
            inside: &[Keys::needed("tip", "a link that is brought to targets", &["link", "title"])],
            ..Keys::needed("arm", "the joints of an arm", &["name", "title", "joints", "hand"])
        },
        Keys::optional("pose", &["name", "title", "about", "joints_rad"]),
        Keys {
            inside: &[
                Keys::optional("screen_frame", &["side_m", "near_m", "below_m"]),
                Keys::optional("body", &["edges_m", "shift_sd_m", "turn_sd_rad"]),
            ],
            ..Keys::optional("outlines", &[])
        },
    ],
    ..Keys::needed("the file", "", &["format", "name", "title", "description"])
};
