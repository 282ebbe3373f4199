"""From a plan to an answer: model, solved mesh, refinement and error estimates."""
