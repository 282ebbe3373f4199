"""Pictures of one result: diagrams (plots/) and views in space (views/)."""
