"""Physics beside closed forms: loads, yield, friction, worn profiles."""
