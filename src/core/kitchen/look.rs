//! Appearance of ingredients, dishes and places on the participant's display: a shape and its colours, from the
//! kitchen's files. The page in the browser draws the shapes.

use serde::Serialize;

/// The shapes that the participant's display can draw: of ingredients, of dishes, of places.
pub const SHAPES: [&str; 32] = [
    "grains", "heap", "block", "sheet", "fillet", "slices", "prawn", "claw", "morsels", "bun", "cheese", "patty",
    "grilled", "round", "bell", "rings", "leaf", "jar", "nigiri", "roll", "burger", "toast", "bowl", "board", "plate",
    "counter", "cutting", "pot", "mat", "grill", "shelf", "tray",
];

/// The appearance of an ingredient, dish or place on the display: "fillet #f58a5f".
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Appearance {
    /// Name of the shape: one of [`SHAPES`].
    pub shape: String,
    /// The colours of the shape as "#rrggbb"; if the list is empty, the shape has its default colours.
    pub colours: Vec<String>,
}

impl Appearance {
    /// Reads an appearance (a shape and up to four colours) from text.
    ///
    /// # Errors
    /// What the text would have to contain.
    pub fn read(text: &str) -> Result<Appearance, String> {
        let mut words = text.split_whitespace();
        let shape = words.next().unwrap_or_default().to_string();
        let colours: Vec<String> = words.map(str::to_string).collect();
        if !SHAPES.contains(&shape.as_str()) {
            return Err(format!("a shape, one of {}, and colours: \"fillet #f58a5f\"", SHAPES.join(", ")));
        }
        let is_colour = |word: &String| {
            let digits = word.strip_prefix('#').unwrap_or_default();
            digits.len() == 6 && digits.bytes().all(|byte| byte.is_ascii_hexdigit())
        };
        match colours.len() <= 4 && colours.iter().all(is_colour) {
            true => Ok(Appearance { shape, colours }),
            false => Err("up to four colours of six hexadecimal digits: \"fillet #f58a5f\"".to_string()),
        }
    }
}
