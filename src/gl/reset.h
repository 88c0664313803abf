// When the driver starts anew, all that was on the GPU is gone.
#pragma once

namespace sfumato::gl {

/// Throws Error(no_gl) when the GPU or its driver was reset since the context was made; nothing of the
/// context is of use then. Drivers that cannot tell say that all is well.
void check_reset();

}  // namespace sfumato::gl
