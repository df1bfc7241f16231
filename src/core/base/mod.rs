//! Basics that every module may use.

pub mod maths;
pub mod number_range;
pub mod rng;
pub mod text;
pub mod time;

/// Declares a table of settings: a struct whose fields have the defaults beside them.
#[macro_export]
macro_rules! settings_table {
    ($(#[$about:meta])* $table:ident { $($(#[$meaning:meta])* $setting:ident: $kind:ty = $default:expr,)* }) => {
        $(#[$about])*
        pub struct $table {
            $($(#[$meaning])* pub $setting: $kind,)*
        }

        impl Default for $table {
            fn default() -> $table {
                $table { $($setting: $default,)* }
            }
        }
    };
}

pub use crate::settings_table;
