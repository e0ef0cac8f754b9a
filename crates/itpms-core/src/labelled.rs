//! Enums whose variants have a word each, for command lines, files and reports.

/// Makes the enum, all of it in its order (`ALL`), and the way to and from its words (`label`, `from_label`).
#[doc(hidden)]
#[macro_export]
macro_rules! labelled {
    ($(#[$about:meta])* $vis:vis enum $name:ident { $($(#[$doc:meta])* $variant:ident = $label:literal,)* }) => {
        $(#[$about])*
        $vis enum $name { $($(#[$doc])* $variant,)* }

        #[allow(dead_code, unreachable_pub, reason = "not every enum is read from a word")]
        impl $name {
            /// In their order.
            pub const ALL: [Self; [$($label),*].len()] = [$(Self::$variant),*];

            /// The word for it.
            #[must_use]
            pub const fn label(self) -> &'static str {
                match self { $(Self::$variant => $label,)* }
            }

            /// The value of a label.
            #[must_use]
            pub fn from_label(label: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|one| one.label() == label)
            }
        }
    };
}
