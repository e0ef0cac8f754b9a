//! `derive(Blank)` of `itpms-core`: what a value's memory holds before it is configured. The code that it writes names that crate's
//! `memory::Blank` and `real::Real`, so it serves that crate alone.

use proc_macro2::TokenStream;
use quote::quote;
use syn::{Data, DeriveInput, Error, Fields, parse_macro_input, parse_quote};

/// A struct is blank if each of its fields is; an enum has its variant marked `#[blank]`. Type parameters are `Real`.
#[proc_macro_derive(Blank, attributes(blank))]
pub fn blank(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    implement(parse_macro_input!(input)).unwrap_or_else(Error::into_compile_error).into()
}

fn implement(mut input: DeriveInput) -> Result<TokenStream, Error> {
    let value = match &input.data {
        Data::Struct(data) => {
            let fields = data.fields.members();
            quote!(Self { #(#fields: crate::memory::Blank::BLANK),* })
        }
        Data::Enum(data) => {
            let mut marked = data
                .variants
                .iter()
                .filter(|variant| variant.attrs.iter().any(|attribute| attribute.path().is_ident("blank")));
            match (marked.next(), marked.next()) {
                (Some(variant), None) if matches!(variant.fields, Fields::Unit) => {
                    let name = &variant.ident;
                    quote!(Self::#name)
                }
                _ => return Err(Error::new_spanned(&input.ident, "one variant without fields is #[blank]")),
            }
        }
        Data::Union(_) => return Err(Error::new_spanned(&input.ident, "a union is never blank")),
    };
    for parameter in input.generics.type_params_mut() {
        parameter.bounds.push(parse_quote!(crate::real::Real));
    }
    let name = &input.ident;
    let (generics, arguments, bounds) = input.generics.split_for_impl();
    Ok(quote! {
        impl #generics crate::memory::Blank for #name #arguments #bounds {
            const BLANK: Self = #value;
        }
    })
}
