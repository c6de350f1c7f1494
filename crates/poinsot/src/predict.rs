//! The verb `predict`: what a planned manoeuvre will tell, before it is flown.
