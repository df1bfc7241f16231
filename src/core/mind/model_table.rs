//! A table of parameters of the human model, and what a file gives of it.
//!
//! A file names a model ([`super::named_models`]) and may give single parameters on top of it. So every table has a
//! twin in which each parameter may be missing; what is missing is taken from the named model.

/// Declares a table of parameters, and its twin of which a file gives some.
macro_rules! model_table {
    (
        $(#[$about:meta])*
        $table:ident, $given:ident {
            $($(#[$meaning:meta])* $parameter:ident: $kind:ty,)*
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize)]
        pub struct $table {
            $($(#[$meaning])* pub $parameter: $kind,)*
        }

        #[doc = concat!("The parameters that a file gives of [`", stringify!($table), "`].")]
        #[derive(Clone, Debug, Default, serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $given {
            $($parameter: Option<$kind>,)*
        }

        impl $given {
            /// The table of a model with the given parameters in their places.
            pub fn on(self, model: $table) -> $table {
                $table { $($parameter: self.$parameter.unwrap_or(model.$parameter),)* }
            }
        }
    };
}

pub(crate) use model_table;
