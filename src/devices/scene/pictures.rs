//! Pictures of items, dishes and places, as the participant's page draws them. `tests/outside/rerun_pictures.py` makes the
//! files, for all looks of the kitchens that come with the program.

use tomcom_core::kitchen::Appearance;

macro_rules! pictures {
    ($($name:literal)*) => { &[$(($name, include_bytes!(concat!("pictures/", $name, ".png")))),*] };
}

const PICTURES: &[(&str, &[u8])] = pictures! {
    "bell-f0913a" "blank" "block-fffdf6" "board" "bun-a86a34" "bun-e7b465" "burger-e0a458-3d9a5f"
    "burger-e0a458-3f7fbf" "burger-e0a458-8a5fb0" "burger-e0a458-d0453a" "card" "cheese-f6c945" "claw-b59a94"
    "claw-c9452f" "counter" "cutting" "fillet-c8484c" "fillet-f08a62" "grains-d9c9a3" "grill" "grilled-6f3b22"
    "grilled-a9713f" "heap-fffdf6" "human_hand" "leaf-74b84a" "mat" "morsels-c9452f-ffe9df" "morsels-f2845c-fff1e6"
    "nigiri-c8484c" "nigiri-f08a62" "nigiri-f2a07e-fff1e6" "patty-b4473f" "patty-c08a5a" "plate" "pot" "prawn-dccfca"
    "prawn-f2845c" "rings-df4b36" "rings-f0913a-fbe3c0" "robot_hand" "roll-c8484c" "roll-ea6a4c-ffe9df" "roll-f08a62"
    "round-df4b36" "sheet-24402f" "shelf" "slices-c8484c" "slices-f08a62" "tray"
};

/// Content of the picture file of this name; `None` if there is no picture.
pub fn named(name: &str) -> Option<&'static [u8]> {
    PICTURES.iter().find(|(of, _)| *of == name).map(|(_, png)| *png)
}

/// The picture of a shape in its colours.
pub fn of_look(look: &Appearance) -> Option<&'static [u8]> {
    let colours: String = look.colours.iter().map(|colour| colour.replace('#', "-")).collect();
    named(&format!("{}{colours}", look.shape))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_found_by_shape_and_colours() {
        let of = |look: &str| of_look(&Appearance::read(look).unwrap()).map(|png| &png[1..4]);
        assert_eq!(of("morsels #f2845c #fff1e6"), Some(b"PNG".as_slice()));
        assert_eq!(of("cutting"), Some(b"PNG".as_slice()));
        assert_eq!(of("fillet #000000"), None, "a fish of another colour would be another fish");
    }
}
